"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 26

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "82ce3f54d974119979a64c91908d714756d4308017ba7164dd8df4dc4e83e7a2"
