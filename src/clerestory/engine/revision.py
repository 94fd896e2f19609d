"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 58

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2ecf3fe8da14439e1f9ac4f8057dd1c9c9900f4c4f8c8b658b693cb7cf34358d"
