"""Drafts a sidecar from an existing description of the same robot: its joints and masses, components by geometry."""
