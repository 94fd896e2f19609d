"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 17

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "a3c4b75d10754847d68ffe94c01283d45b5e896ee5d4036663884223b9989a93"
