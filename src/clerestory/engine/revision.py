"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 59

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "a8ad01fd3d11af754cf290338e9d1be0630b719894eac44e8e3326d235c1ec17"
