"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 42

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2cdf9e6d02eb898df0c74971406cdcac3a94a3fd65e1d36ed52e753606f70323"
