"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 44

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "8aadeb07658ad6a213fe5a7de1417c21f1dd990b41d112e85fad94d270715279"
