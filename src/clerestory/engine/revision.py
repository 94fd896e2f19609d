"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 5

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "565ae1f81eb6d88e524e2446a864d3286bbb83fa91bed75ad6a118911ce9bb0b"
