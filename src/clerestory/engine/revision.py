"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 41

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2d10655943dc84a0c6e168114cea265c150aab25b89deee06154c948ef695da0"
