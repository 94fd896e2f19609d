"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 21

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "463c04a3fd3f04754634780ada210b1e342aa92aef7894e6ba4b20b5f952ab42"
