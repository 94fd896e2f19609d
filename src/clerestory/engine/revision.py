"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 9

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "ec431e471910f05dd4f5474968dbeda0426759fc85c4a4860cf1ef0870ec6569"
