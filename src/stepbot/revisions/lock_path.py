"""Path of a sidecar's lock; imports nothing, so that a cached result is found quickly."""

from pathlib import Path


def lock_path(sidecar: Path) -> Path:
    """``arm.lock.json`` beside ``arm.robot.yaml``."""
    return sidecar.with_name(f"{sidecar.name.removesuffix(sidecar.suffix).removesuffix('.robot')}.lock.json")
