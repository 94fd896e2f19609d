"""Revision of the estimators, a part of the key of stored matrices.

A matrix that another revision traced is not used. `scripts/record_revision.py` raises
the revision when the code that matrices depend on has changed; a test asks for it.
"""

ESTIMATOR_REVISION = 1

# Of the sources of this revision
ESTIMATOR_DIGEST = "0460765473afc59dbf1db5ef0f6ad5792961e4ebe7ea8f9e7f9c10a37bf600d6"
