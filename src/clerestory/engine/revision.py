"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 2

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "400ca8fffa3f51038436453fd9dfe223652f53017f81635e39f116d17ca7ec6b"
