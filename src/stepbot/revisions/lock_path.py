"""Path of a sidecar's lock; imports nothing, so that a cached result is found quickly."""

from pathlib import Path


def lock_path(sidecar: Path, variant: str = "") -> Path:
    """``arm.lock.json`` beside ``arm.robot.yaml``, ``arm.long.lock.json`` of its variant ``long``."""
    name = sidecar.name.removesuffix(sidecar.suffix).removesuffix(".robot")
    return sidecar.with_name(f"{name}{variant and f'.{variant}'}.lock.json")
