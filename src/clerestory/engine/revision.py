"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 40

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "03ed6fc070486052ea3f640f9f8638c6568306dd1031be2f3e639353ccb55173"
