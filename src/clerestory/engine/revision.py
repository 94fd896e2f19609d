"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 46

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "b04f1c0efe914901df52b716ad26ea1b15bf691fc61b36311f0457d75ac4630a"
