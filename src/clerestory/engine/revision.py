"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 18

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "574ba4b8c65792efe96add49767e6c7825b003b220204d1d8ba9cffa589c2aa7"
