"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 56

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "edb0db136815d7af9a0fa7f4cfb202c30b81c44ac559692ebbeaaa48676f0a7b"
