"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 18

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "8a44813b91170a045d5b8b897b368065f58eaea9c78cfaf63401fa456cd66006"
