"""The text of a drafted sidecar."""
