"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 33

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2ea5ef8352b64857e608ea18420c9a1fe15c9d311766117e465d616f48e50b13"
