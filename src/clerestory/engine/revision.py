"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 19

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "eae8c8c6a055b62da3a22368eed3efbeee1f4ecd2285b313124ac13201defff5"
