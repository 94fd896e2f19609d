"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 33

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "9e7009cf861bc8db9717e6f730581f97eb9971c490948a67681256179f28866c"
