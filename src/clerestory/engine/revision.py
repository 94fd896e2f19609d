"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 38

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "6d2541f1a51bd2fe9f8cc0c6a6a72cb743e9ad71b8e2457a1bc5f99cceadc9cb"
