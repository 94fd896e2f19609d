"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 30

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "81dd4c73f6be28872a7374172d85858d17527aacd250b7947c2971665b4e1ffb"
