"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 29

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "c5ffbb40c14b625f9089af02869f950e2710fbe2116962571709d6c8521a2414"
