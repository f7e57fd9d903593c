"""Validation properties: the volumes, areas and centroids that a STEP file states, compared with what was read."""
