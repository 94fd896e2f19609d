"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 27

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "a55b8af2848fd2337ce2f3afcf543782cbd24cda61d982a167dabcb52023f921"
