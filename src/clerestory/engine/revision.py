"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 47

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "38a3bfe9fd780cb7b25fdaafe6a5cdf9671b8eef6ae6fd850ab4e3dc6d0c9a6f"
