"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 20

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "830a1a00dd407a972f5042e4e5d2df1c1a7aa033617fde55a86578174b42d77b"
