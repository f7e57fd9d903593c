"""Compares revisions of one assembly, and their effect on a sidecar; for ``pipeline`` and above.

snapshot     an assembly by its fingerprints: shape, pose and mass of each component, axis of each joint
lock_file    a snapshot as ``<robot>.lock.json``, and back
shapes       whether two shapes are the same
matching     corresponding components of two snapshots
comparison   a lock with the current assembly; paths that no longer match the same components, and their replacements
findings     differences as diagnostics at the lines of the sidecar
differences  differences of two snapshots as rows of a table
"""

from pathlib import Path


def lock_path(sidecar: Path, variant: str = "") -> Path:
    """``arm.lock.json`` beside ``arm.robot.yaml``, ``arm.long.lock.json`` of its variant ``long``."""
    name = sidecar.name.removesuffix(sidecar.suffix).removesuffix(".robot")
    return sidecar.parent / f"{name}{variant and f'.{variant}'}.lock.json"
