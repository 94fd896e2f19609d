"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 53

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "57200e58b2071dfefb6b696dd8af7f5e53cee3cfdb8c64e9f2cc1019d43c16c9"
