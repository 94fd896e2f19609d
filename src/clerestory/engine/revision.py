"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 7

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "0795d451b4642992c5d39ed01c391766fb62ed64b3b98a1683c4e5d15a513022"
