"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 52

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2b296a9d96285d7f24c9f5f80b7512551900781d66ecc2eab72d5447552e80d6"
