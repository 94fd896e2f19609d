"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 8

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "35f0dd101e161a7e3bc70b91b532d7ab1afc8a5b866688ae7fccda9fc40e8e08"
