"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 62

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "cd25baf1d4b949db16c13bf9f0d671d9f23664b917102e71c9bba653afd143a4"
