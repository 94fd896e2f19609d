"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 39

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "77f8fe0b9f8bd47f57c2a12629afc7c4ccd6aa3a31f8c21eb79c4e9cc8060bb9"
