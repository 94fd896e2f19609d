"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 16

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "44711833d09b449a15b44558a6bf9a67aaa60a80dcd448bf20a9083ee3aa1a35"
