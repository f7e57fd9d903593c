"""Compares revisions of one assembly, and their effect on a sidecar; for ``pipeline`` and above."""

from pathlib import Path


def lock_path(sidecar: Path, variant: str = "") -> Path:
    """``arm.lock.json`` beside ``arm.robot.yaml``, ``arm.long.lock.json`` of its variant ``long``."""
    name = sidecar.name.removesuffix(sidecar.suffix).removesuffix(".robot")
    return sidecar.parent / f"{name}{variant and f'.{variant}'}.lock.json"
