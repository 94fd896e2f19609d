"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 40

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "ecae143d49a2b2cc449ddab7191a462d45952a030f8053edc9be9b120ee543d0"
