"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 36

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "ccb389507d6184b7d56d3a46c97d8f6e4eeb801b5a6abfef1553f895d71f589b"
