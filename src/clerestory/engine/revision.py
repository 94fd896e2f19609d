"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 43

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "010458ada5d76163647ed4c22c929ebc869e89f83883595fbf11032a3b76c5ac"
