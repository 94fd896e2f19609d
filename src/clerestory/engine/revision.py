"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 28

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "1217a6854c7bf727154d9f06f0d3824b9750fb6ac707b9cd5b1fbbda3b0f519e"
