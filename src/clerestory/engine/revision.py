"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 49

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "3821943b550f27caed51d3caf7e5bfa8f75642a877f820cf1797385c04c9947a"
