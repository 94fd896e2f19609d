"""Revision of the estimators, a part of the key of stored matrices.

Matrices traced by another revision are not used. `scripts/record_revision.py`
increments the revision if the code that matrices depend on has changed, as required by
a test.
"""

ESTIMATOR_REVISION = 31

# SHA-256 of the sources of this revision
ESTIMATOR_DIGEST = "bc43be9a515fd33c8a70c394febf00d2fbf2222fc6d3a339fc8ba9535427415d"
