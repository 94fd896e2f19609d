"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 32

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "db66791a38d833f45269ead0808093fec0696d6401a1c4e8fad03011896dbdcb"
