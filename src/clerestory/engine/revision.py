"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 32

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "fc8d46540c82fcf40212d9e337d470b0d50ec4dcdab0e43f40ce45179c6c21eb"
