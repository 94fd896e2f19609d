"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 35

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "c2ee966493b5f32ef63481452932a3484ab517d210334ba6c6b070fa414143b3"
