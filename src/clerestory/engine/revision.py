"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 3

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "01bc7e1cca14db5d65e17c871eb9c71f1af5291d918e6e2e9ec39c7eaa868684"
