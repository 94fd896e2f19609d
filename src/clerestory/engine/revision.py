"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 61

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "74a812734625c4754acd0154ec567987f038f61282750e51c0f79860d78e867c"
