"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 45

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "c0831fedf46e372ea27f2c65b7b42cd689cf50ce750d0577eab1c576394197e2"
