"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 22

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "53bbba4a55ea7787fb451b1d585aad0bf500accedf34594eb2b40d6648ddd464"
