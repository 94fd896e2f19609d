"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 15

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "11d26ffd7888119d8784f0b9c1c1547e341d194df2fb1de6aa1fab8de9afc8b8"
