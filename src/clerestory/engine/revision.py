"""Revision of the estimators, a part of the key of stored matrices.

A matrix that another revision traced is not used. `scripts/record_revision.py` raises
the revision when the code that matrices depend on has changed; a test asks for it.
"""

ESTIMATOR_REVISION = 1

# Of the sources of this revision
ESTIMATOR_DIGEST = "2f1a34d94460e833b9a6aaa30b529874f344c8a01da811726a61d3893fcbecff"
