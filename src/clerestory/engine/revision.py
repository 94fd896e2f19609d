"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 19

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "3b8bc0e914c58a129235d0953aa1eb4cd5aeeccda3387737d27611b3718e91d9"
