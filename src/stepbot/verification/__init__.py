"""The proof: what engines see in the files, compared with the robot, or with each other.

One comparison serves all formats and engines (:mod:`stepbot.verification.compare`), with one table of tolerances
(:mod:`stepbot.verification.tolerances`). Files that were just written are compared with their robot
(:mod:`stepbot.verification.conversion`); any files with each other (:mod:`stepbot.verification.files`).
"""

from .conversion import Provers, Written, verify
from .files import verify_files

__all__ = ["Provers", "Written", "verify", "verify_files"]
