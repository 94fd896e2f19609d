"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 51

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "487e3815dfee8699d8f7d125c993b06246e7f8c0422a834f4f5969e544a6e2c5"
