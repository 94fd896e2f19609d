"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 12

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "2b0c9c1955b6d6a9d8feebf308ae669193aef143d760a10838983c2479efaa0b"
