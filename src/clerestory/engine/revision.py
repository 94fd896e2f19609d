"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 24

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "719b5a46dc5d87246068fb477445b548948f3175a89f4480b712b0155cc3271e"
