"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 49

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "387572b14f7babd4d38230e234115c3a2932f425e5fec7286d73ac2d0aa2fc35"
