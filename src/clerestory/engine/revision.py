"""Revision of the estimators, a part of the key of stored matrices.

A matrix that another revision traced is not used. `scripts/record_revision.py` raises
the revision when the code that matrices depend on has changed; a test asks for it.
"""

ESTIMATOR_REVISION = 1

# Of the sources of this revision
ESTIMATOR_DIGEST = "ad7a8b4b5742e59a0dfc07fd1a1f8f81a381e1d9786261be4cc96cf6952f1961"
