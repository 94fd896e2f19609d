"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 36

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "796f469f826cf359063baa1d1cf85831fa24839b744519f044c9021321975f07"
