"""``stepbot check``: check sidecars, optionally against their STEP files."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepbot.diagnostics import Diagnostic, Diagnostics, counted, listed

from .command import PATH, Command, display_options, ignore_option
from .diagnostic_text import printable
from .machine_output import output_format_option
from .progress import progress_bar
from .reading import (
    description_options,
    reading_options,
    reject_descriptions,
    reject_one_step_for_all,
    report_trouble,
    variant_option,
)
from .table import show_joint_rows, write_filled
from .terminal import Display, show_diagnostics, write_document, write_result, write_verdict

_MOST_LISTED = 6

if TYPE_CHECKING:
    from stepbot.pipeline.conversion import Checked, Options
    from stepbot.pipeline.locking import FixedSidecar


def fix_paths(sidecar: Path, options: "Options", diagnostics: Diagnostics) -> "FixedSidecar | None":
    """Rewrite the paths of certainly renamed components in a sidecar and its lock; None where nothing was written."""
    from stepbot.pipeline.locking import fix_renamed_paths
    from stepbot.revisions import lock_path
    from stepbot.runtime.file import write_file

    fixed = fix_renamed_paths(sidecar, options, diagnostics)
    if fixed is None:
        return None
    trouble = Diagnostics()
    write_file(sidecar, fixed.sidecar, trouble, replaces=fixed.before)
    diagnostics.extend(trouble)
    if trouble.has_errors:
        return None
    write_file(lock_path(sidecar), fixed.lock, diagnostics)
    return fixed


def _difference(fixed: "FixedSidecar") -> str:
    """What changed in a sidecar, as a unified diff."""
    import difflib  # only `--fix` needs it

    name = fixed.path.as_posix()
    before, after = (content.decode("utf-8").splitlines() for content in (fixed.before, fixed.sidecar))
    return "\n".join(map(printable, difflib.unified_diff(before, after, name, name, lineterm="", n=0)))


_NAMED = "the one that the sidecar names"


class CheckCommand(Command):
    """Allows ``--step`` without a value or before a STEP file, so that a hook may append sidecars right after it."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Supply the value of ``--step`` before click looks for one."""
        joined: list[str] = []
        for argument in args:
            if joined and joined[-1] == "--step":
                from stepbot.robot.step_names import is_step_name

                is_step = is_step_name(argument)
                joined[-1:] = [f"--step={argument}"] if is_step else [f"--step={_NAMED}", argument]
            else:
                joined.append(argument)
        if joined and joined[-1] == "--step":
            joined[-1] = f"--step={_NAMED}"
        return super().parse_args(ctx, joined)


@click.command(
    cls=CheckCommand,
    epilog="Example: stepbot check --step arm.robot.yaml\n\nAfter a CAD change: stepbot check --fix arm.robot.yaml",
)
@click.argument("sidecars", metavar="[SIDECAR|DIR]...", nargs=-1, type=PATH)
@click.option("--step", metavar="[FILE]", help="Also read the STEP file of the sidecar, or FILE, and build the robot.")
@click.option(
    "--fix", is_flag=True, help="Rewrite paths of components that the CAD has certainly renamed; implies --step."
)
@click.option("--strict", is_flag=True, help="Turn warnings into errors.")
@ignore_option
@reading_options
@variant_option
@description_options
@display_options
@output_format_option
def command(options: "Options", sidecars: tuple[Path, ...], step: str | None, fix: bool, display: Display) -> int:
    """Check sidecars and report all errors. Folders are searched recursively; the default is the current folder.

    In place of a sidecar, a URDF, SDFormat or MJCF is checked for what a conversion to other formats would lose.

    STEP files are read only with --step. A STEP file that differs from the sidecar's lock file (`stepbot lock`) is
    compared with it. No files are written, except by --fix. Diagnostics are printed to standard output.
    """
    from stepbot.jobs.discovery import find_sidecars, variants_of
    from stepbot.jobs.incremental import check

    strict = options.strict
    options = options._replace(step=None if step in (None, _NAMED) else Path(str(step)), strict=False)
    diagnostics = Diagnostics()
    checked: dict[str, Checked] = {}
    failed: dict[str, Diagnostics] = {}
    named, sidecars = sidecars, tuple(find_sidecars(sidecars or (Path(),), diagnostics))
    reject_one_step_for_all(options.step, named, sidecars)
    open_step = fix or step is not None
    if open_step:
        reject_descriptions("--step" if step is not None else "--fix", sidecars)
    fixes: list[FixedSidecar] = []
    with progress_bar([str(path) for path in sidecars] if open_step else (), options) as progress:
        for sidecar in sidecars:
            progress(str(sidecar))
            if fix and (fixed := fix_paths(sidecar, options, diagnostics)) is not None:
                fixes.append(fixed)
            reported: dict[Diagnostic, list[str]] = {}
            for variant in (options.variant,) if options.variant else ("", *variants_of(sidecar)):
                label = f"{sidecar.as_posix()} ({variant})" if variant else sidecar.as_posix()
                of_one = Diagnostics()
                checked[label] = check(sidecar, options._replace(variant=variant), of_one, open_step=open_step)
                if strict:
                    of_one.make_strict()
                failed |= {label: of_one} if of_one.has_errors else {}
                for one in of_one:
                    reported.setdefault(one, []).append(variant)
                diagnostics.add_ignored(of_one.ignored)
            diagnostics.extend(_of_variants(one, variants) for one, variants in reported.items())
    report_trouble(options.cache, diagnostics)
    if display.json:
        from stepbot.report.words import joint_table_document

        return write_document(
            {
                "files": [path.as_posix() for path in sidecars],
                "joint_tables": {label: joint_table_document(one.joint_table) for label, one in checked.items()},
                **({"fixed": [_document(fixed) for fixed in fixes]} if fix else {}),
                "ignored": len(diagnostics.ignored),
            },
            diagnostics,
        )
    for fixed in fixes:
        write_result(_difference(fixed))
    if display.shows_results:
        _show(checked, failed, display, open_step=open_step)
    if checked:
        after_verdict = len(checked) == 1 and bool(failed) and display.shows_results  # of several, it is the sum
    else:
        after_verdict = write_verdict("nothing checked", diagnostics, display)
    show_diagnostics(diagnostics, display, as_result=True, after_verdict=after_verdict)
    if open_step and len(sidecars) == 1 and not (diagnostics.has_errors or display != Display()):
        from shlex import quote

        path = quote(sidecars[0].as_posix())
        write_result(f"joints, each with its axis and faces: -v    next: stepbot convert {printable(path)}")
    return diagnostics.exit_code


def _document(fixed: "FixedSidecar") -> dict[str, Any]:
    return {"file": fixed.path.as_posix(), "paths": dict(fixed.paths), "diff": _difference(fixed)}


def _of_variants(diagnostic: Diagnostic, variants: list[str]) -> Diagnostic:
    """A diagnostic of some variants of a sidecar, with their names; as it is if the sidecar itself has it."""
    if "" in variants:
        return diagnostic
    names = listed(variants, _MOST_LISTED)
    return diagnostic._replace(notes=(*diagnostic.notes, f"variant{'s' * (len(variants) > 1)} {names}"))


def _show(
    checked: "Mapping[str, Checked]", failed: Mapping[str, Diagnostics], display: Display, *, open_step: bool
) -> None:
    """Print the verdict on each robot and its joints: all with -v, else the names of those on weak evidence."""
    from stepbot.pipeline.conversion import is_description

    for label, robot in checked.items():
        name = printable(label)
        if label in failed:
            then = "STEP not read, correct these first" if open_step and not robot.is_loaded else ""
            write_verdict(f"{name}:", failed[label], display, then)
        elif robot.links or not robot.named:
            several = f"{name}: " if len(checked) > 1 else ""
            read = open_step or is_description(Path(label))
            size = f"{counted(robot.links, 'link')}, {counted(robot.joints, 'joint')}; STEP not read (--step)"
            size = size if robot.named else "modules not read (--step)"
            write_filled(f"{several}ok: {robot.robot if read else size}")
        if display.verbose:
            show_joint_rows(robot.joint_table)
        elif any(row.evidence.doubt for row in robot.joint_table):
            from stepbot.report.words import weak_joints

            write_filled(weak_joints(robot.joint_table))
