"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 36

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "38d6831a7a285f4110a61fa647be397b9f77615bbac552ed1a1c314f219bf3bf"
