"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 54

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "c05b670c5ad7f60bd98d001e4ffef2d78f2fd26f5549bb9bda402d6aed35aca0"
