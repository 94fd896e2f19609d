"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 25

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "be2a3c5ceb57732281f4e6d06801c8c32b140c835d1dec033a04ed07a45acd0d"
