"""Revisions of one assembly: what a CAD change did to the components that a sidecar binds.

snapshot     an assembly by its fingerprints: shape, pose and mass of each component, axis of each joint
lock_file    a snapshot as ``<robot>.lock.json``, and back
shapes       whether two shapes are the same
matching     which component of one snapshot is which of the other
bindings     paths of the sidecar that no longer name what they named, and what they should be
findings     differences as diagnostics at the lines of the sidecar
differences  differences of two snapshots as rows of a table
"""
