"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 30

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "798a8f396a3c2205f81c642b65c50d2b66f2e01f5762daba8dca62aa9a6bbf7d"
