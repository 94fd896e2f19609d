"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 47

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "0a8ac9b368ffddffe3c21398c74d80b8e07e1bf28d74a30ace1f25774a6d37cf"
