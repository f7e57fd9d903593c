"""Solids as closed meshes: their overlaps and intersections. Independent of CAD and sidecar."""
