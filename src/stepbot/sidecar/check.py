"""Checks a sidecar for contradictions between its parts, without the STEP."""

from stepbot.diagnostics import Diagnostics, did_you_mean

from .connections import check_connections
from .device_rules import check_actuators, check_sensors
from .ignored import check_ignored
from .joint_rules import check_closures, check_joints, check_mimics, check_turned_frames
from .located import Sidecar
from .modules import ModuleSection
from .own_part import own_part
from .references import check_names, check_references
from .shapes import is_for_mjx
from .text import BoundedDiagnostics, TooManyFaultsError
from .unit_rules import check_densities, check_joint_units, check_magnitudes, check_weights_as_forces

_OF_OWN_STEP = ("parts", "mass", "step_density", "step_encoding")
_WITH_OWN_LINKS = ("root", "materials", "defaults")
"""Keys that are about the STEP and the links of this file alone, but for the defaults' shapes for MJX."""
_OF_FILE = ("variant", "set", "rename")


def _check_orientation(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
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
        diagnostics.add("SB128", message, sidecar.span(*keys), help=[f"write {directions}"])


def _check_modules(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report SB121, SB137, SB150 and SB152 of a composing sidecar; the files of modules are not read."""
    document = sidecar.document
    if not document.modules:
        return
    _check_own_step(sidecar, diagnostics)
    moved = {joint.child.partition("/")[0] for joint in document.joints.values()}
    for name, module in document.modules.items():
        _check_source(sidecar, name, module, diagnostics)
        _check_effects(sidecar, name, module, name in moved or module.mirror_of in moved, diagnostics)


def _check_own_step(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
    """Report own links whose parts are in no file, and settings of a STEP that is not there."""
    document = sidecar.document
    if document.step:
        if not document.links:
            help = ["links: {base: {rest: true}}", "or remove `step`; of a STEP that is a module, write `file`"]
            diagnostics.add(
                "SB121", "sidecar: missing key 'links': no link has parts of `step`", sidecar.span("step"), help=help
            )
        return
    for name, link in document.links.items():
        if link.parts or link.rest:
            key = "parts" if link.parts else "rest"
            message = f"link '{name}': '{key}' without 'step': missing key 'step'"
            help = ["step: ARM.step", "of a link without parts, give `inertial` alone"]
            diagnostics.add("SB121", message, sidecar.key_span("links", name, key), help=help)
    of_modules = is_for_mjx(document.defaults.collision) and document.defaults.model_fields_set == {"collision"}
    for key in (*_OF_OWN_STEP, *(() if document.links else _WITH_OWN_LINKS)):
        if key in document.model_fields_set and not (key == "defaults" and of_modules):
            message = f"sidecar: '{key}' without 'step': it does not apply to modules"
            help = [f"remove `{key}`; `set` changes it in the file of a module"]
            diagnostics.add("SB137", message, sidecar.key_span(key), help=help)


def _check_source(sidecar: Sidecar, name: str, module: ModuleSection, diagnostics: Diagnostics) -> None:
    """Report SB150, neither or both of `file` and `mirror_of`, and SB152, no module to mirror."""
    modules, original = sidecar.document.modules, module.mirror_of
    span = sidecar.span("modules", name, "mirror_of")
    if original is None:
        if module.file is None:
            message = f"module '{name}': neither `file` nor `mirror_of` is set"
            diagnostics.add("SB150", message, sidecar.key_span("modules", name))
    elif module.file is not None:
        help = ["remove `file`: it is the file of the other module", "`mirror: y` mirrors a file"]
        diagnostics.add("SB150", f"module '{name}': both `file` and `mirror_of` are set", span, help=help)
    elif original == name:
        message = f"module '{name}': mirror_of: it is the module itself"
        diagnostics.add("SB152", message, span, help=["name the module that it is the mirror image of"])
    elif original not in modules:
        diagnostics.add(
            "SB152", f"module '{name}': mirror_of: no module '{original}'", span, help=did_you_mean(original, modules)
        )
    elif modules[original].mirror_of is not None:
        help = [f"mirror_of: {modules[original].mirror_of}"]
        diagnostics.add("SB152", f"module '{name}': mirror_of: '{original}' is itself a mirror image", span, help=help)


def _check_effects(
    sidecar: Sidecar, name: str, module: ModuleSection, has_joint: bool, diagnostics: Diagnostics
) -> None:
    """Report SB137: keys that need another one."""

    def report(key: str, needs: str, help: str) -> None:
        message = f"module '{name}': '{key}' without '{needs}'"
        diagnostics.add("SB137", message, sidecar.key_span("modules", name, key), help=[help])

    if module.at is None and (module.mirror_of is None or has_joint):
        for key in ("by", "offset"):
            if getattr(module, key) is not None:
                help = "of a joint, name the port as its `child`, or give `origin: {offset: ...}`"
                report(key, "at", help if has_joint else "name the link or frame that it is fixed to, or `at: world`")
    if module.flip and not (module.mirror or module.mirror_of):
        report("flip", "mirror", "`flip` reverses joints of a mirrored module; in its own file, reverse `axis`")
    if module.mirror_of is not None and module.file is None:
        for key in _OF_FILE:
            if getattr(module, key):
                report(key, "file", f"set it in module '{module.mirror_of}', which is mirrored with it")


_OF_OWN_LINKS = (check_references, check_connections)
_CHECKS = (
    check_names,
    _check_modules,
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


def check_sidecar(sidecar: Sidecar, diagnostics: Diagnostics) -> None:
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
    varied = bool(sidecar.variant or sidecar.is_changed)
    local.hand_over(diagnostics, sidecar.path.as_posix(), complete=complete, varied=varied)
