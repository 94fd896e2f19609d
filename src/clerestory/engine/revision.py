"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 50

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "ba565856a27be6d7e7bc34689478743739d26dc2c16dd64f8f51a3ccec53576f"
