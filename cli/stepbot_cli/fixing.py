"""``stepbot check --fix``: renamed paths rewritten in sidecars."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepbot.diagnostics import Diagnostics

from .diagnostic_text import printable

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Options


@dataclass(frozen=True)
class Fixed:
    """A sidecar that was rewritten."""

    sidecar: Path
    before: str
    after: str
    paths: Mapping[str, str]
    """The new path for each one that changed."""

    @property
    def difference(self) -> str:
        """What changed, as a unified diff."""
        name = self.sidecar.as_posix()
        before, after = self.before.splitlines(), self.after.splitlines()
        return "\n".join(map(printable, difflib.unified_diff(before, after, name, name, lineterm="", n=0)))

    @property
    def document(self) -> dict[str, Any]:
        """What ``--json`` prints."""
        return {"file": self.sidecar.as_posix(), "paths": dict(self.paths), "diff": self.difference}


def fix_paths(sidecar: Path, options: "Options", found: Diagnostics) -> Fixed | None:
    """Rewrite the paths of certainly renamed components in a sidecar and its lock; None where nothing was written."""
    from stepbot.pipeline.locking import fix_renamed_paths
    from stepbot.revisions import lock_path
    from stepbot.runtime.file import write_file

    fixed = fix_renamed_paths(sidecar, options, found)
    if fixed is None:
        return None
    trouble = Diagnostics()
    write_file(sidecar, fixed.sidecar, trouble, replaces=fixed.before)
    found.extend(trouble)
    if trouble.has_errors:
        return None
    write_file(lock_path(sidecar), fixed.lock, found)
    return Fixed(sidecar, fixed.before.decode("utf-8"), fixed.sidecar.decode("utf-8"), fixed.paths)
