"""``stepbot render``: a picture of a robot or a STEP file."""

import re
from collections.abc import Iterable, Mapping
from importlib import import_module
from math import degrees, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostics, Span, did_you_mean
from stepbot.runtime.file import replace_file

from .command import PATH, Command, display_options
from .diagnostic_text import printable
from .progress import progress_bar
from .reading import package_path_option, reading_options, report_trouble, variant_option
from .terminal import Display, show_diagnostics_of_use, write_document, write_result

if TYPE_CHECKING:
    from stepbot.pictures.camera import View
    from stepbot.pictures.picture import Picture, Sheet
    from stepbot.pictures.scene import Subject
    from stepbot.pipeline.conversion import Options
    from stepbot.robot.model import Joint, Robot


def checked_picture_name(context: click.Context, option: click.Parameter, path: Path | None) -> Path | None:  # noqa: ARG001
    """The path of a PNG file; another suffix is a usage error."""
    if path is not None and path.suffix.lower() != ".png":
        raise click.BadParameter(f"'{path.name}' is not a PNG file; choose a name that ends in .png")
    return path


def require_packages() -> None:
    """Import what drawing needs, so that a missing package ends the command before a long STEP file is read."""
    from stepbot.pictures.picture import PACKAGES

    for package in PACKAGES:
        import_module(package)


def require_plots() -> None:
    """The same for plots."""
    from stepbot.driving.plots import PACKAGE

    import_module(PACKAGE)


def write_picture(path: Path, picture: "Picture", diagnostics: Diagnostics) -> None:
    """Write a PNG file; SB004 if that is impossible."""
    from stepbot.pictures.picture import png_bytes

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, png_bytes(picture.pixels))
    except OSError as error:
        help = ["choose another file with -o"]
        diagnostics.add("SB004", f"cannot write: {error.strerror or error}", Span(path.as_posix()), help=help)


def picture_lines(path: Path, picture: "Picture", labels: bool) -> list[str]:
    """The written file, and what it does not show."""
    lines = [printable(path.as_posix())]
    for names, why in ((picture.hidden if labels else (), "behind other parts"), (picture.unlabelled, "without label")):
        lines += [printable(f"{why}: {', '.join(dict.fromkeys(names))}")] if names else []
    return lines


_HINT = "--joint"
_SLACK = 1e-9

joint_option = click.option(
    "--joint",
    "joints",
    multiple=True,
    metavar="NAME=VALUE",
    help="Position of a joint, such as elbow=30deg or slide=12mm; may be repeated. Plain numbers are radians or "
    "metres. Loops are closed.  [default: as drawn]",
)


def read_positions(robot: "Robot", texts: Iterable[str]) -> dict[str, float]:
    """Positions [rad] or [m] by coordinate.

    Raises:
        click.BadParameter: No ``NAME=VALUE``, an unknown joint or one that follows another, an invalid quantity, or a
            position outside the joint's limits.
    """
    from stepbot.robot.posing import coordinates

    joints = coordinates(robot)
    positions: dict[str, float] = {}
    for text in texts:
        name, equals, value = text.rpartition("=")
        if not equals or not name:
            raise click.BadParameter(f"'{text}' is not NAME=VALUE, such as elbow=30deg", param_hint=_HINT)
        joint = _joint(robot, joints, name.strip())
        if joint.name in positions:
            raise click.BadParameter(f"joint '{joint.name}' is given twice", param_hint=_HINT)
        positions[joint.name] = _position(joint, value.strip())
    return positions


def position_words(joint: "Joint", q: float) -> str:
    """A position in degrees or millimetres."""
    return f"{round(q * 1e3, 6):.6g} mm" if _slides(joint) else f"{round(degrees(q), 6):.6g} deg"


def _joint(robot: "Robot", joints: Mapping[str, "Joint"], name: str) -> "Joint":
    from stepbot.robot.posing import leader_of

    if name not in joints:
        fixed = any(joint.name == name for joint in robot.joints)
        closes = any(closure.name == name for closure in robot.closures)
        parts = [known for known in joints if known.startswith(f"{name}_")] if fixed else []
        near = " or ".join(parts) or "".join(did_you_mean(name, joints)) or f"choose from {', '.join(joints)}"
        why = "has no position of its own" if closes or parts else "is fixed" if fixed else "does not exist"
        remedy = near if joints else "the robot has no moving joint"
        raise click.BadParameter(f"joint '{name}' {why}; {remedy}", param_hint=_HINT)
    leader = leader_of(robot, name)
    if leader != name:
        raise click.BadParameter(f"joint '{name}' follows '{leader}'; set '{leader}' instead", param_hint=_HINT)
    return joints[name]


def _position(joint: "Joint", text: str) -> float:
    from stepbot.sidecar.units import ANGLE, LENGTH, UnitError, read_quantity

    try:
        quantity = read_quantity(text, LENGTH if _slides(joint) else ANGLE)
    except UnitError as error:
        hints = "".join(f"; {hint}" for hint in error.hints)
        raise click.BadParameter(f"joint '{joint.name}': {error}{hints}", param_hint=_HINT) from None
    q, lower, upper = quantity.value, joint.limit.lower, joint.limit.upper
    if not lower - _SLACK <= q <= upper + _SLACK:
        limits = f"{position_words(joint, lower)} to {position_words(joint, upper)}"
        message = f"joint '{joint.name}': {position_words(joint, q)} is outside its limits, {limits}"
        other, scale = ("mm", 1e-3) if _slides(joint) else ("deg", radians(1.0))
        if quantity.dimension is None and lower <= q * scale <= upper:
            message += f"; if the unit is {other}, write {joint.name}={text}{other}"
        raise click.BadParameter(message, param_hint=_HINT)
    return q


def _slides(joint: "Joint") -> bool:
    from stepbot.robot.model import JointKind

    return joint.kind is JointKind.PRISMATIC


_SIZE = re.compile(r"(\d{2,4})x(\d{2,4})")
_VIEWS = ("corner", "iso", "front", "left", "back", "right", "top", "bottom")


def _size(context: click.Context, option: click.Parameter, text: str) -> tuple[int, int]:  # noqa: ARG001
    match = _SIZE.fullmatch(text)
    if match is None:
        raise click.BadParameter(f"'{text}' is not a size such as 1200x900")
    return int(match[1]), int(match[2])


def _view(context: click.Context, option: click.Parameter, text: str) -> "View":  # noqa: ARG001
    from stepbot.pictures.camera import VIEWS, View

    if text in VIEWS:
        return VIEWS[text]
    try:
        azimuth, elevation = map(float, text.split(","))
    except ValueError:
        near = "".join(did_you_mean(text, VIEWS))
        remedy = near or f"choose from {', '.join(VIEWS)}, or azimuth,elevation in degrees"
        raise click.BadParameter(f"unknown view '{text}'; {remedy}") from None
    if not (abs(azimuth) <= 360.0 and abs(elevation) <= 90.0):
        raise click.BadParameter(f"'{text}': the azimuth is up to 360, the elevation up to 90 degrees")
    return View(azimuth, elevation)


@click.command(cls=Command, epilog="Example: stepbot render arm.robot.yaml --joint elbow=30deg -o arm.png")
@click.argument("target", metavar="TARGET", type=PATH)
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="FILE",
    callback=checked_picture_name,
    help="PNG file to write.  [default: name of TARGET, in the current folder]",
)
@joint_option
@click.option(
    "--view",
    default="corner",
    show_default=True,
    metavar="VIEW",
    callback=_view,
    help=f"{', '.join(_VIEWS)}, or AZIMUTH,ELEVATION in degrees; the front is +x.",
)
@click.option("--module", metavar="NAME", help="Draw one module of a composed robot alone, where it is in the whole.")
@click.option("--labels", is_flag=True, help="Name links and joints, or components, and draw the axes of joints.")
@click.option(
    "--size", default="1200x900", show_default=True, metavar="WxH", callback=_size, help="Width and height in pixels."
)
@click.option(
    "--samples",
    type=click.IntRange(1, 16),
    default=3,
    show_default=True,
    metavar="N",
    help="N x N rays for each pixel; more give less noise.",
)
@reading_options
@variant_option
@package_path_option
@display_options
def command(
    options: "Options",
    target: Path,
    output: Path | None,
    joints: tuple[str, ...],
    view: "View",
    module: str | None,
    labels: bool,
    size: tuple[int, int],
    samples: int,
    display: Display,
) -> int:
    """Draw TARGET, a sidecar's robot, a STEP file, or a URDF, SDFormat or MJCF file, without a window.

    Needs the packages of `pip install 'stepbot[render]'`. Links and parts are drawn opaque, with their meshes as
    converted. In a STEP file, --labels names the children of the root; for an exploded view of all parts, see
    `stepbot inspect --picture`.
    """
    from stepbot.pictures.picture import NothingToDraw, Sheet, draw

    require_packages()
    path = output or Path(target.name.removesuffix(target.suffix).removesuffix(".robot") + ".png")
    sheet = Sheet(*size, samples=samples, view=view, labels=labels)
    diagnostics, picture = Diagnostics(), None
    with progress_bar(("read", "build", "render"), options) as progress:
        subject, positions = _subject(target, options, joints, module, diagnostics, progress)
        progress("render")
        try:
            picture = draw(subject, sheet) if subject is not None else None
        except NothingToDraw as error:
            diagnostics.add(
                "SB020", str(error), Span(target.as_posix()), help=["see `stepbot inspect` for what it contains"]
            )
    if picture is not None:
        write_picture(path, picture, diagnostics)
    return _report(path, sheet, picture, positions, diagnostics, options, display)


def _subject(
    target: Path,
    options: "Options",
    joints: tuple[str, ...],
    module: str | None,
    diagnostics: Diagnostics,
    progress: Any,
) -> tuple["Subject | None", dict[str, str]]:
    """What to draw, and the positions of the joints in words; None after errors."""
    from stepbot.pipeline.picturing import assembly_to_draw, robot_to_draw
    from stepbot.robot.step_names import is_step_name

    if not is_step_name(target.name):
        return _robot_subject(robot_to_draw(target, options, diagnostics, progress), joints, module)
    if module is not None:
        raise click.BadParameter("a STEP file has no modules; give a sidecar", param_hint="--module")
    if joints:
        raise click.BadParameter("a STEP file has no joints; give a sidecar", param_hint=_HINT)
    progress("read")
    return assembly_to_draw(target, options, diagnostics), {}


def _robot_subject(
    robot: "Robot | None", joints: tuple[str, ...], module: str | None
) -> tuple["Subject | None", dict[str, str]]:
    from stepbot.pictures.scene import robot_subject
    from stepbot.robot.posing import NotReached, coordinates, posed

    if robot is None:
        return None, {}
    names = coordinates(robot)
    try:
        q = posed(robot, read_positions(robot, joints))
    except NotReached as error:
        ends = ", ".join(f"{name}={position_words(names[name], value)}" for name, value in error.reached.items())
        message = f"the loops or the limits of other joints stop the mechanism on its way there, at {ends}"
        raise click.BadParameter(message, param_hint=_HINT) from None
    links = None if module is None else _links_of_module(robot, module)
    return robot_subject(robot, q, links), {name: position_words(names[name], value) for name, value in q.items()}


def _links_of_module(robot: "Robot", name: str) -> tuple[str, ...]:
    links = {module.name: module.links for module in robot.modules}
    if name not in links:
        near = "".join(did_you_mean(name, links)) or f"choose from {', '.join(links)}"
        remedy = near if links else "the robot has no modules"
        raise click.BadParameter(f"no module '{name}'; {remedy}", param_hint="--module")
    return links[name]


def _report(
    path: Path,
    sheet: "Sheet",
    picture: "Picture | None",
    positions: dict[str, str],
    diagnostics: Diagnostics,
    options: "Options",
    display: Display,
) -> int:
    report_trouble(options.cache, diagnostics)
    written = picture is not None and not diagnostics.has_errors
    if display.json:
        document = {
            "file": path.as_posix() if written else None,
            "size": [sheet.width, sheet.height],
            "positions": positions,
            "places": {} if picture is None else {name: list(place) for name, place in picture.places.items()},
            "hidden": [] if picture is None else list(picture.hidden),
            "unlabelled": [] if picture is None else list(picture.unlabelled),
        }
        return write_document(document, diagnostics)
    show_diagnostics_of_use(diagnostics, display, f"{path.as_posix()}: not drawn")
    if picture is not None and written and not display.quiet:
        write_result("\n".join(picture_lines(path, picture, sheet.labels)))
    return diagnostics.exit_code
