"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 60

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "cecef1b4f1188efb81de45922f5555c6f3309fa0259a39b62fe3ad287c234622"
