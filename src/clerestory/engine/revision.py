"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 25

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "9f9792692aac530e41230d6f364e05deef0d318bcc45279438fccb34bb43b28c"
