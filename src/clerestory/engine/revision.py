"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 32

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "a3f5186dcdba1d541b3cf3142694b696a8be89999713512f18b0403ccff5f715"
