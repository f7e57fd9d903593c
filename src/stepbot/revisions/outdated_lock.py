"""Checks whether a lock is older than its sidecar."""

import shlex

from stepbot.assemble.binder import listed
from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.component_paths import component_paths
from stepbot.sidecar.located import Sidecar
from stepbot.step.structure.paths import quoted

from .snapshot import Snapshot


def report_outdated(lock: Snapshot, sidecar: Sidecar, found: Diagnostics) -> None:
    """Report joints and paths of the sidecar that the lock lacks, because the sidecar was edited later: SB016."""
    document = sidecar.document
    locked = {joint.name for joint in lock.joints}
    joints = [f"joint '{name}'" for name in document.joints if name not in locked]
    closures = [f"closure '{name}'" for name in document.closures if name not in locked]
    known = {reference.path for reference in lock.references}
    given = dict.fromkeys(place.pattern for place in component_paths(document))
    paths = [f"path {quoted(pattern)}" for pattern in given if pattern not in known]
    missing = (*joints, *closures, *paths)
    if missing:
        remedy = f"check the robot, then update the lock file: `{shlex.join(['stepbot', 'lock', sidecar.path.name])}`"
        count = f"{len(missing)} names of the sidecar are" if len(missing) > 1 else "one name of the sidecar is"
        message = f"outdated lock file: {count} not in it"
        found.add("SB016", message, sidecar.span(), help=[remedy], notes=listed(missing))
