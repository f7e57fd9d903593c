"""Checks a sidecar for contradictions between its parts, without the STEP."""

from stepbot.diagnostics import Diagnostics

from .connections import check_connections
from .device_rules import check_actuators, check_sensors
from .ignored import check_ignored
from .joint_rules import check_closures, check_joints, check_mimics, check_turned_frames
from .located import Sidecar
from .module_rules import check_modules
from .own_part import own_part
from .references import check_names, check_references
from .text import BoundedDiagnostics, TooManyFaultsError, file_name
from .unit_rules import check_densities, check_joint_units, check_magnitudes, check_weights_as_forces


def _check_orientation(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB128: forward is along up."""
    root = sidecar.document.root
    if root is None or root.axes is None:
        return
    up, forward = root.axes
    if up[-1] == forward[-1]:
        others = [axis for axis in "xyz" if axis != up[-1]]
        directions = " or ".join(f"`{sign}{axis}`" for axis in others for sign in ("", "-"))
        keys = ("root", "forward")
        message = f"root: `forward: {forward}` is not perpendicular to `up: {up}`"
        found.add("SB128", message, sidecar.span(*keys), help=[f"write {directions}"])


_OF_OWN_LINKS = (check_references, check_connections)
_CHECKS = (
    check_names,
    check_modules,
    _check_orientation,
    check_joints,
    check_joint_units,
    check_mimics,
    check_closures,
    check_turned_frames,
    check_actuators,
    check_sensors,
    check_magnitudes,
    check_densities,
    check_weights_as_forces,
)


def check_sidecar(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report what contradicts itself, or refers to something that does not exist."""
    local, complete = BoundedDiagnostics(), True
    try:
        # References into modules are resolved when these are read.
        own = own_part(sidecar)
        for check in _OF_OWN_LINKS:
            check(own, local)
        for check in _CHECKS:
            check(sidecar, local)
        check_ignored(sidecar.root, local)
    except TooManyFaultsError:
        complete = False
    local.hand_over(found, file_name(sidecar.path), complete=complete)
