"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 63

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "f480297906ebd42f5da882c44f7fe2b0422768295d3146f49fca497617be9d38"
