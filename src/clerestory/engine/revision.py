"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 1

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2f1a34d94460e833b9a6aaa30b529874f344c8a01da811726a61d3893fcbecff"
