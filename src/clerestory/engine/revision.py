"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 6

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "0c93a6f1d0e6573bc277aa93e578622aa3a7418cfed9af2ce018ed8356471936"
