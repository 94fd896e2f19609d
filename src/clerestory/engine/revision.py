"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 34

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "01200e9cc63497519253ad15f1983f3f356f17d86dc1ac2228bdbdb2a86a0c68"
