"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 39

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "fa48a129226362bc6ac5d5cb191fc7b12199460f655dc1e0ce2b928088f6ffe5"
