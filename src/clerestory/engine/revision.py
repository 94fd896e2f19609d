"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 10

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "a7d84312d0bed5d5e9cd16a3a864945104e48018848bae2b1ecdaa9499048e77"
