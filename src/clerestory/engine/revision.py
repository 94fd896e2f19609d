"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 19

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "e2887e7358a4268d74ad3e105c9703c78a963d419f14a58c00eeab2aab3c3800"
