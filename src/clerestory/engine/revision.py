"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 11

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "f2ff4cbd37678580368dbd2ca4ed3d9035d920492269d04f2c3320ad1b8060c3"
