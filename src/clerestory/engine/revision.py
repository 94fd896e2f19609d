"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 55

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "fbfd8509f7ecccab5f7045ba1a723a2add7f4a796e67bfe9322f49b45c7375b0"
