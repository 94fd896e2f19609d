"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 44

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "9b26ee7c733c7b2c0d5704ed4514a634136c57a18099c45fc8f07c1d6c6776e2"
