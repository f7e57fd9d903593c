"""Solids as closed meshes: which of them overlap, and what they have in common. Knows neither CAD nor sidecar."""
