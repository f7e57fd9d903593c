"""Checks of the directions in ``root``."""

from stepbot.diagnostics import Diagnostics

from .located import Sidecar


def check_orientation(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB144: forward is along up."""
    root = sidecar.document.root
    if root is None or root.axes is None:
        return
    up, forward = root.axes
    if up[-1] == forward[-1]:
        others = [axis for axis in "xyz" if axis != up[-1]]
        directions = " or ".join(f"`{sign}{axis}`" for axis in others for sign in ("", "-"))
        keys = ("root", "forward")
        message = f"root: `forward: {forward}` is not perpendicular to `up: {up}`"
        found.add("SB144", message, sidecar.span(*keys), help=[f"write {directions}"])
