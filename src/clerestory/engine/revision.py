"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 18

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "70aa1a0e71d7634d30f0173dc62eda6a4226f33797581a1d86e142a10818322e"
