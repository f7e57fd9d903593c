"""One sidecar and its assembly become one robot, with what the lock file records of an earlier revision."""

import os.path
from contextlib import closing
from functools import cache, partial
from pathlib import Path

from msgspec.structs import replace

from stepbot.assemble import UNREVISED, BuiltRobot, build_robot
from stepbot.diagnostics import Diagnostics, Span
from stepbot.revisions import lock_path
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.scale import LARGEST, SMALLEST, other_units
from stepbot.robot.validity import check_robot
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.tree import ELEMENTS, subject
from stepbot.step.assembly import SMALL, Assembly
from stepbot.step.structure.paths import ComponentPaths

from .conversion import Options
from .loading import Loading
from .sidecars import what_to_read


def build(
    sidecar: Sidecar, assembly: Assembly, loading: Loading, options: Options, diagnostics: Diagnostics
) -> BuiltRobot | None:
    """Build and check the robot; equal meshes are shared. None where errors prevent a robot.

    Args:
        sidecar: The sidecar, without errors of its own.
        loading: Measures the bodies, and searches for overlaps.
        options: Cache, and whether another STEP was given than the one that the sidecar names.
    """
    measures = partial(loading.measures, diagnostics)
    revised = UNREVISED
    lock = lock_path(sidecar.path, sidecar.variant)
    if not sidecar.is_changed and os.path.lexists(lock):  # without one, revisions are not imported
        from .locking import compared_with_lock

        compared = compared_with_lock(sidecar, assembly, measures, loading.content, options, diagnostics)
        revised = UNREVISED if compared is None else compared.revised
    process, timeout = loading.mesh_worker, options.timeout
    built = build_robot(assembly, sidecar, measures, diagnostics, options.cache, process, revised, timeout)
    if built is None:
        return None
    built = replace(built, robot=share_meshes(built.robot))
    check_robot(built.robot, diagnostics, sidecar.span(), assembly.unit, places=cache(partial(places, sidecar)))
    if sidecar.document.expect is not None and not diagnostics.has_errors:
        from .expectations import check_expected

        paths = ComponentPaths(assembly.components)

        def matches(path: str) -> list[str]:
            return [assembly.components[index].path for index in paths.find(path).topmost]

        check_expected(sidecar, built.robot, matches, diagnostics)
    return built


def built_of(sidecar: Sidecar, step: Path, options: Options, diagnostics: Diagnostics) -> tuple[BuiltRobot, Assembly]:
    """Read a STEP file, and build and check the robot of a sidecar.

    Raises:
        StepbotError: There are errors.
    """
    with closing(Loading(step, what_to_read(sidecar, options), options, diagnostics)) as loading:
        assembly = loading.assembly(diagnostics)
        built = build(sidecar, assembly, loading, options, diagnostics)
        diagnostics.raise_if_errors()
        assert built is not None  # a missing robot always has an error
        built.double_counting.report(options.timeout)
    return built, assembly


def places(sidecar: Sidecar) -> dict[str, Span]:
    """The places of the robot's elements in the sidecar, by the subjects of messages."""
    document = sidecar.document
    keys = [(section, name) for section in ELEMENTS for name in getattr(document, section)]
    places = {subject(key): sidecar.key_span(*key) for key in keys} | {"step": sidecar.span("step")}
    for link in document.links:
        for key in ("inertial", "collision"):
            places[f"{subject(('links', link))}: {key}"] = sidecar.key_span("links", link, key)
    return places


def report_size(assembly: Assembly, diagnostics: Diagnostics, *, drafted: bool = False) -> None:
    """Report SB420, an assembly of tens of metres, or below a millimetre: drawn in another unit than declared.

    Args:
        drafted: Whether joints are inferred, by clearances and gaps that are not those of smaller parts.
    """
    box = assembly.bounds(0)
    size = 0.0 if box is None else max(high - low for low, high in zip(*box, strict=True))
    help = list(other_units(size, assembly.unit))
    if drafted:
        help += ["joints are drafted by clearances and gaps of larger parts: look at each, or draw it enlarged"]
    if size > LARGEST:
        message = f"{assembly.source}: size of {size:.3g} m; check its length unit ({assembly.unit})"
        diagnostics.add("SB420", message, Span(assembly.source), help=help[:1])
    elif 0.0 < size < (SMALL if drafted else SMALLEST):
        message = f"{assembly.source}: size of {size * 1e3:.3g} mm; check its length unit ({assembly.unit})"
        diagnostics.add("SB420", message, Span(assembly.source), help=help)
