"""Compares the observations of engines with the robot, or with each other. May be called by ``pipeline`` and above.

One comparison serves all formats and engines (:mod:`stepbot.verification.compare`), with one table of tolerances
(:mod:`stepbot.verification.deviation`). Written files are compared with their robot
(:mod:`stepbot.verification.conversion`); any files with each other (:mod:`stepbot.verification.files`).
"""

from .conversion import Provers, Written, verify
from .files import verify_files

__all__ = ["Provers", "Written", "verify", "verify_files"]
