"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 32

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "de02498e2b0e0a6658aabc32336fc0118a592928ee3d744e11153fea15e38e23"
