"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 23

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "7c11f2a93631eb3479f47ddaa41b70ca4fd4b637e2511aeffdf8ac7565b433ce"
