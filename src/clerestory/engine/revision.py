"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 4

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "33596c93fca59c66caab8d2e2095ff60b12c435592bab05ff0ae702c2409df76"
