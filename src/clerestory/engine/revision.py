"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 1

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "35630fbd2d1295408e04eefb45e96effe51a040719db1c903ea0bb166f7daa0a"
