"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 13

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "aabe18be49b7041e5c6cb1f287c99ed08e919b353409554a208fe23990712396"
