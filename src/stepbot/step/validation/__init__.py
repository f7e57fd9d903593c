"""Validation properties: the volumes, areas and centroids that a STEP file states, compared with the geometry read."""
