"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 64

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "7e27ea77878ac231c986c931db8475f3e3acc9eb4378d1166aae591eb4df47f4"
