"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 14

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "b762757a6606c60516da4a4d0534d17d6d4a8dddcff3916ed09730c70b628e4f"
