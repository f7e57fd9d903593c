"""A sidecar from an existing description of the same robot: its joints and masses, the components found by geometry."""
