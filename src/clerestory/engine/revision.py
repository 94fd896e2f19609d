"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 20

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "b8bf1625e3ca51ffcff595fb512388ddcfc15759cfb8c428c162c9f6c15252f5"
