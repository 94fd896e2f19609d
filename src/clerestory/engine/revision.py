"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 45

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "5b3eedb8d6fbd0ea2b81d09770cb83e9d44e9157f862f5329e7dc25810f295e7"
