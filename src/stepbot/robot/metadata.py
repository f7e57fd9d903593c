"""Who maintains a robot's description, and its licence: what packages state that are published."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Metadata:
    """What the sidecar states about the description; empty where it does not."""

    maintainer: str = ""
    """Name of the maintainer."""
    email: str = ""
    """Address of the maintainer."""
    license: str = ""
    """Licence of the description, by its SPDX identifier where it has one."""
    version: str = ""
    """Three numbers: ``1.2.3``."""
    description: str = ""


NO_METADATA = Metadata()
"""Nothing is stated."""
