"""``stepbot inspect``: show the contents of a STEP file."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .command import PATH, Command, display_options
from .progress import progress_bar
from .reading import reading_options, report_trouble, variant_option
from .render import checked_picture_name, picture_lines, require_packages, write_picture
from .terminal import Display, screen_width, show_diagnostics, write_document, write_result, write_verdict

if TYPE_CHECKING:
    from stepbot.diagnostics import Diagnostics
    from stepbot.pictures.picture import Picture
    from stepbot.pipeline.conversion import Options
    from stepbot.pipeline.stages import Inspection
    from stepbot.step.assembly import Assembly

    from .inspection_rows import Choice

_APART = 0.8
"""How far the parts of an exploded view move, relative to their distance from the middle of what they belong to."""


@click.command(cls=Command, epilog="Example: stepbot inspect arm.step --between base forearm")
@click.argument("step", metavar="STEP", type=PATH)
@click.option(
    "--features", is_flag=True, help="List the axes of each component, with the origin that selects each axis."
)
@click.option(
    "--between",
    nargs=2,
    metavar="A B",
    help="Show only the axes shared by two components, the strongest first; -v shows all, and axes up to 2 mm apart.",
)
@click.option("--depth", type=click.IntRange(0), metavar="N", help="List components down to N levels below the root.")
@click.option(
    "--filter",
    "glob",
    metavar="GLOB",
    default="",
    help="List components that match a path or glob at any depth, such as '*screw*'.",
)
@click.option("--tree", is_flag=True, help="Show the components as a tree of names instead of a list of paths.")
@click.option("--unfold", is_flag=True, help="List repeated occurrences individually.")
@click.option(
    "--picture",
    type=PATH,
    metavar="FILE",
    callback=checked_picture_name,
    help="Write an exploded view as a PNG file; the listed components have labels.",
)
@reading_options
@variant_option
@display_options
def command(
    options: "Options",
    step: Path,
    features: bool,
    between: tuple[str, str] | None,
    depth: int | None,
    glob: str,
    tree: bool,
    unfold: bool,
    picture: Path | None,
    display: Display,
) -> int:
    """Show the components of a STEP file: paths to paste into a sidecar, names, solids, volumes, sizes, densities.

    Sizes and centers are those of bounding boxes of the meshes along the assembly axes. Between flat faces across
    an axis they are exact; elsewhere the mesh may be short by its chordal deviation, by default 0.2 % of the body's
    diagonal, and the size has no more digits than that. Without --features, repeated occurrences within a
    subassembly are listed as one line with a count. --json always includes all components.

    --picture draws all parts apart, each with its name; equal parts share one. Needs `pip install 'stepbot[render]'`.

    If STEP is a sidecar, the STEP file of the sidecar is shown, and --between also accepts link names.
    """
    from stepbot.pipeline.stages import inspect

    from .inspection_rows import Choice

    if tree and (features or between):
        raise click.UsageError(f"--tree cannot be combined with {'--features' if features else '--between'}")
    if picture is not None:
        require_packages()
    drawn: Picture | None = None
    with progress_bar(("read", "render"), options) as progress:
        progress("read")
        inspection = inspect(step, options)
        diagnostics = inspection.diagnostics
        if picture is not None and inspection.assembly is not None:
            progress("render")
            drawn = _exploded_view(
                inspection.assembly, Choice(depth, glob, folded=False), not unfold, picture, diagnostics
            )
    report_trouble(options.cache, diagnostics)
    if display.json:
        document = _document(inspection, between, features)
        if picture is not None:
            document["picture"] = None if drawn is None else picture.as_posix()
        return write_document(document, diagnostics)
    incomplete = "not read" if inspection.assembly is None else "read in part"
    after_verdict = write_verdict(f"{step.as_posix()}: {incomplete}", diagnostics, display)
    show_diagnostics(diagnostics, display, after_verdict=after_verdict)
    if inspection.assembly is not None and display.shows_results:
        choice = Choice(depth, glob, folded=not (unfold or features))
        write_result(_text(inspection, between, choice, features=features, tree=tree, verbose=display.verbose))
    if picture is not None and drawn is not None and display.shows_results:
        write_result("\n".join(picture_lines(picture, drawn, labels=True)))
    return diagnostics.exit_code


def _exploded_view(
    assembly: "Assembly", choice: "Choice", folded: bool, path: Path, diagnostics: "Diagnostics"
) -> "Picture | None":
    """Draw and write the exploded view; None after an error."""
    from stepbot.diagnostics import Span
    from stepbot.pictures.picture import NothingToDraw, Sheet, draw
    from stepbot.pipeline.picturing import assembly_subject, part_labels

    from .inspection_rows import listed

    indices = [row.component.index for row in listed(assembly, choice).rows]
    labels = part_labels(assembly, indices, folded=folded)
    try:
        picture = draw(assembly_subject(assembly, labels, apart=_APART), Sheet(labels=True))
    except NothingToDraw as error:
        diagnostics.add("SB020", str(error), Span(assembly.source))
        return None
    write_picture(path, picture, diagnostics)
    return None if diagnostics.has_errors else picture


def _document(inspection: "Inspection", between: tuple[str, str] | None, features: bool) -> dict[str, Any]:
    from .contents import inspection_document, shared_axes_document
    from .inspection_rows import shared_axes

    document = inspection_document(inspection, features=features)
    if between and inspection.assembly is not None:
        document["between"] = shared_axes_document(shared_axes(inspection.assembly, inspection.links, *between))
    return document


def _text(
    inspection: "Inspection",
    between: tuple[str, str] | None,
    choice: "Choice",
    *,
    features: bool,
    tree: bool,
    verbose: bool,
) -> str:
    from .inspection_rows import shared_axes
    from .inspection_text import inspection_text, shared_axes_text

    width = screen_width(sys.stdout)
    if between and inspection.assembly is not None:
        shared = shared_axes(inspection.assembly, inspection.links, *between)
        return shared_axes_text(shared, width, verbose=verbose)
    return inspection_text(inspection, choice, features=features, tree=tree, verbose=verbose, width=width)
