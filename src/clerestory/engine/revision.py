"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 33

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "39ae78ebbb6a5b9ee12b667d3808fec4cbc34a5c66724ec9a8648a70e5a2b5f0"
