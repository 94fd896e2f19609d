"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 35

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "35046ec0e2f515b6f2ba6d85412c6abebffa4d28274589a273a4d83c063fc2ce"
