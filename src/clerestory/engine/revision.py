"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 48

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "b80c471c089478b1200817adb7220bf45cdffb5eb445d7601a340d373a1addd9"
