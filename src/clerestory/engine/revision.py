"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 57

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "a0ae0137bde2093ac3f33d02b2a016beb79747d4bc9b85978c26e73bcb16b266"
