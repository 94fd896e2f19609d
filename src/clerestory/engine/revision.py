"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 37

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2fd44dc22cf6227a749aee0e7edc201456acdee927038cb92b654127f62a7841"
