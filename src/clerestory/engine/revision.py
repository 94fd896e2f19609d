"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 55

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "8394c67eded59f70ce05dd5d29230bf36ef1682165d6c492f2f95f067507fe20"
