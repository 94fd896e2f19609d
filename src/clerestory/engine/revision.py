"""Revision of the estimators, a part of the key of stored matrices.

A matrix that another revision traced is not used. `scripts/record_revision.py` raises
the revision when the code that matrices depend on has changed; a test asks for it.
"""

ESTIMATOR_REVISION = 1

# Of the sources of this revision
ESTIMATOR_DIGEST = "dd942b0de355e3741b556a35350f28fec9b5837e64b632aefe09ca9899a3820f"
