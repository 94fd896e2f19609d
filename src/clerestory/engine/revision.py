"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 34

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "4bf53a08d528042d35e966bed8f3e07ebed28d97978810c8a021db3d137b23c6"
