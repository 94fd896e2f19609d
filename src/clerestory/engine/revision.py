"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 32

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "b0154f031b8235fb17d250952127dea3b431240c726906276f6cc7faa8c786b5"
