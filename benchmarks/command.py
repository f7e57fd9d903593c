"""The command line: generate assemblies, compare, and write down what came of it.

python -m benchmarks generate definitions -o FOLDER     one of the large assemblies, or all
python -m benchmarks cold SIDECAR|STEP...               against the bare script, other converters, an earlier stepbot
python -m benchmarks check SIDECAR|STEP...              the start and unchanged input against ``import click``
python -m benchmarks batch DIR|LIST                     all robots below a folder or on a list, on one core and on two
python -m benchmarks memory DIR|LIST                    memory of a batch of 1,000 copies over time
python -m benchmarks cores SIDECAR...                   the bare script twice, in turn and at once: what two cores give
python -m benchmarks scaling                            ever more definitions, ever more occurrences
python -m benchmarks gate --against REVISION            processor time of the working tree against a tag's
python -m benchmarks users STEP... --against REVISION   the table of docs/commands.md
python -m benchmarks live SIDECAR                       from a save of it to the page of `watch` and `view --edit`
python -m benchmarks report                             tables in benchmarks/NOTES.md from the results of ``--keep``
python -m benchmarks inference                          links and joints from plain STEP files, against the known ones
python -m benchmarks drafts                             drafts of published assemblies by `stepbot init`, against labels
python -m benchmarks drafting STEP                      copies of an assembly in a row: links, joints and stops
python -m benchmarks collision STEP                     convex pieces of its solids, by stepbot and by CoACD
python -m benchmarks steps SIDECAR...                   hulls of parts against ``auto``, in MuJoCo
python -m benchmarks steps MJCF MJCF...                 files of one robot against the first of them, in MuJoCo
python -m benchmarks follow BEFORE AFTER                lag, overshoot, error and speed of position motors in MuJoCo
python -m benchmarks follow FOLDER                      position motors whose effort limits cost lag, and the least lag
python -m benchmarks gym reach MJCF                     steps per second of its environments, one and sixteen
python -m benchmarks smoke                              all of it on something small: does it still run?

It runs on Linux and macOS, memory is measured on Linux alone, and nothing else should run meanwhile.
"""

import argparse
import json
import os
import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from statistics import median, stdev
from tempfile import TemporaryDirectory

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.stages import Options, convert
from stepbot.robot.step_names import is_step_name, step_stem
from stepbot.step.assembly import ReadOptions
from stepbot.step.reader import read_assembly

from . import contenders as who
from . import gate, live, users
from .assemblies import ASSEMBLIES, Assembly, generate
from .calibration import print_calibration
from .collision import compare_pieces, shapes_of
from .comparison import compare
from .contenders import ROOT, Case, Contender
from .drafts import page_with_scores, score_drafts
from .environments import environment_speeds
from .following import following_table, limits_tables
from .inference import corpus_folder, measure, page_with_table, read_for_inference
from .inference_time import drafting_time
from .many_robots import batch_memory, distinct_copies, memory_table
from .named_step import NAMED
from .report import write_report
from .results import keep, machine, table
from .stepping import compare_steps
from .timing import CommandFailed, timed

_PROBE = "\nframes:\n  benchmark_probe: {{link: {link}, origin: {{xyz: [0, 0, 0.001]}}}}\n"
_DEFAULT_SHAPE = re.compile(r",? *collision: \w+")
_CONTACT = re.compile(r"^    contact: .*\n", re.MULTILINE)
_LINK = re.compile(r"^links:.*\n(?:\s*#.*\n)*  ([\w.-]+|\"[^\"]+\"):", re.MULTILINE)
GATED = tuple(
    ROOT / "robot_library" / folder / f"{name}.robot.yaml"
    for folder, name in (
        ("stepbot_arm2", "arm2"),
        ("stepbot_four_bar", "four_bar"),
        ("stepbot_desk_arm", "desk_arm"),
        ("stepbot_delta", "delta"),
        ("stepbot_quadruped", "quadruped"),
        ("robotiq_2f85", "2f85"),
        ("franka_panda", "panda"),
        ("kinova_gen3", "gen3"),
        ("abb_yumi", "yumi"),
        ("kuka_youbot", "youbot"),
    )
)
"""The robots of the gate."""
CALIBRATED = (1.0, 1.025, 1.05, 1.075, 1.1)
"""Factors of processor time for which calibration states how often the gate fails."""
SCALES = {
    "definitions": [Assembly(definitions=count) for count in (125, 250, 500, 1000)],
    "occurrences": [Assembly(definitions=10, occurrences=count) for count in (1, 10, 100, 1000)],
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one of the commands above."""
    options = _parser().parse_args(arguments)
    with TemporaryDirectory(prefix="stepbot-benchmark-") as folder:
        return options.run(options, Path(folder)) or 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.partition("\n")[0])
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    made = commands.add_parser("generate", help="write a large assembly, with a sidecar")
    made.add_argument("names", nargs="+", choices=sorted(ASSEMBLIES), metavar="NAME")
    made.add_argument("-o", "--output", type=Path, default=Path("build/assemblies"), metavar="FOLDER")
    made.set_defaults(run=_generate)
    for name, run in (("cold", _cold), ("check", _check), ("cores", _cores)):
        one = commands.add_parser(name, help="compare on sidecars and the STEP files that they name, or on STEP files")
        one.add_argument("files", nargs="+", type=Path, metavar="SIDECAR|STEP")
        one.add_argument("--step", type=Path, metavar="FILE", help="STEP file, instead of the one that is named")
        if run is _cold:
            one.add_argument("--against", metavar="REVISION", help="an earlier stepbot too")
            one.add_argument("--only-cold", action="store_true", help="no edits, no verification: for large files")
            one.add_argument("--collision", metavar="SHAPE", help="this shape, instead of those of the sidecars")
            one.add_argument("--cascadio", metavar="PYTHON", help="cascadio too, in this interpreter's environment")
        _common(one, run)
    many = commands.add_parser("batch", help="compare one core with two")
    many.add_argument("robots", type=Path, metavar="DIR|LIST")
    many.add_argument("--dask", action="store_true", help="Dask clusters of one, two and four workers too")
    _common(many, _batch)
    held = commands.add_parser("memory", help="memory of a batch of many distinct copies over time")
    held.add_argument("robots", type=Path, metavar="DIR|LIST")
    held.add_argument("--count", type=int, default=1000, metavar="N", help="number of copies [default: 1000]")
    held.add_argument("-j", "--jobs", type=int, default=2, metavar="N", help="processes [default: 2]")
    held.set_defaults(run=_memory)
    scaled = commands.add_parser("scaling", help="time and memory over the size")
    scaled.add_argument("--only", choices=sorted(SCALES), help="more of this alone")
    _common(scaled, _scaling)
    gated = commands.add_parser("gate", help="fail if the working tree needs 5 %% more processor time than a revision")
    gated.add_argument("--against", metavar="REVISION", help="[default: the last tag]")
    gated.add_argument("--calibrate", type=int, metavar="N", help="instead, N rounds of HEAD against itself")
    gated.set_defaults(run=_gate)
    waited = commands.add_parser("users", help="what users wait for: the table of docs/commands.md")
    users.add_options(waited)
    waited.set_defaults(run=_users)
    live.add_command(commands, case_of)
    commands.add_parser("report", help="update the tables in benchmarks/NOTES.md").set_defaults(run=_report)
    drafted = commands.add_parser("inference", help="how many joints are found, how many drafted ones are right")
    drafted.add_argument("--only", default="", metavar="TEXT", help="robots whose name contains this")
    drafted.add_argument("--write", action="store_true", help="update the table in benchmarks/DRAFTS.md")
    drafted.set_defaults(run=_inference)
    scored = commands.add_parser("drafts", help="`stepbot init` on published assemblies, against labels")
    scored.add_argument("--only", default="", metavar="TEXT", help="assemblies whose name contains this")
    scored.add_argument(
        "--held-out", action="store_true", help="those held out, which no rule may be tuned on, instead"
    )
    scored.add_argument("--write", action="store_true", help="update the tables in benchmarks/DRAFTS.md")
    scored.add_argument(
        "--calibration", action="store_true", help="how often each kind of evidence is right, leave-one-out"
    )
    scored.set_defaults(run=_drafts)
    rows = commands.add_parser("drafting", help="time to draft copies of an assembly in a row")
    rows.add_argument("step", type=Path)
    rows.add_argument("--copies", type=int, nargs="+", default=[1, 3, 6], metavar="N")
    rows.set_defaults(run=_drafting)
    pieces = commands.add_parser("collision", help="convex pieces of solids, by stepbot and by CoACD")
    pieces.add_argument("step", type=Path)
    pieces.set_defaults(run=_collision)
    stepped = commands.add_parser("steps", help="MuJoCo's steps per second with hulls and `auto`, or of MJCF files")
    stepped.add_argument("files", nargs="+", type=Path, metavar="SIDECAR|MJCF")
    stepped.add_argument("-n", "--rounds", type=int, default=7, metavar="N", help="[default: 7]")
    stepped.set_defaults(run=_steps)
    followed = commands.add_parser("follow", help="how position motors follow, before and after a change")
    followed.add_argument("before", type=Path, help="output folders; of an earlier conversion if AFTER is given")
    followed.add_argument("after", type=Path, nargs="?", help="folder of output folders")
    followed.set_defaults(run=_follow)
    learned = commands.add_parser("gym", help="steps per second of environments of stepbot.gym")
    learned.add_argument("task", choices=("reach", "stand"))
    learned.add_argument("model", type=Path, metavar="MJCF")
    learned.set_defaults(run=_gym)
    commands.add_parser("smoke", help="run everything once on something small").set_defaults(run=_smoke)
    return parser


def _common(parser: argparse.ArgumentParser, run: object) -> None:
    parser.add_argument("-n", "--rounds", type=int, default=5, metavar="N", help="[default: 5]")
    parser.add_argument("--no-warm-up", dest="warm_up", action="store_false", help="count the first round too")
    parser.add_argument("--memory", action="store_true", help="measure memory too")
    parser.add_argument("--keep", metavar="NAME", help="keep the results for `report`")
    parser.set_defaults(run=run)


def _generate(options: argparse.Namespace, _: Path) -> None:
    for name in options.names:
        print(generate(ASSEMBLIES[name], options.output, name))


def _cold(options: argparse.Namespace, folder: Path) -> int:
    against = [who.BARE, who.COLD]
    if not options.only_cold:
        against += [who.VERIFIED, who.EDITED, who.EDITED_VERIFIED, who.PLAIN]
    if options.cascadio:
        against.append(who.cascadio(options.cascadio))
    if options.against:
        against.append(who.revision(options.against, folder / "earlier"))
    return _compare_files(options, folder, against)


def _check(options: argparse.Namespace, folder: Path) -> int:
    return _compare_files(options, folder, [who.CLICK, who.VERSION, who.HELP, who.CHECK, who.UNCHANGED])


def _cores(options: argparse.Namespace, folder: Path) -> int:
    return _compare_files(options, folder, [who.IN_TURN, who.AT_ONCE])


def _compare_files(options: argparse.Namespace, folder: Path, contenders: Sequence[Contender]) -> int:
    """Compare on each file; one that a contender rejects is reported, and the others are measured."""
    rejected, shape = 0, getattr(options, "collision", None)
    for file in options.files:
        sidecar = drafted(file, folder / "drafts") if is_step_name(file.name) else file
        if shape is not None:
            sidecar = with_collision(sidecar, shape, folder)
        try:
            _compare(options, case_of(sidecar, options.step, folder), contenders)
        except CommandFailed as error:
            print(f"\n{file}: not measured: {error}", flush=True)
            rejected += 1
    return 1 if rejected else 0


def _collision(options: argparse.Namespace, _: Path) -> None:
    assembly = read_assembly(options.step, ReadOptions(), Diagnostics())
    assert assembly is not None
    counts = [sum(component.body == body for component in assembly.components) for body in range(len(assembly.bodies))]
    print(compare_pieces(list(assembly.bodies), counts))


def _follow(options: argparse.Namespace, _: Path) -> None:
    before, after = options.before, options.after
    print("\n".join(following_table(before, after) if after else limits_tables(before)), flush=True)


def _steps(options: argparse.Namespace, folder: Path) -> None:
    written = [file for file in options.files if file.suffix == ".xml"]
    if len(written) == 1:
        raise SystemExit("steps: nothing to compare with; name two MJCF files of one robot")
    for sidecar in options.files:
        if sidecar in written:
            continue
        files = {}
        for shape in ("hull", "auto"):
            made = with_collision(sidecar, shape, folder)
            output = folder / f"{sidecar.stem}-{shape}"
            report = convert(made, Options(output, formats=("mjcf",), verify=False))
            assert not report.diagnostics.has_errors, [str(one) for one in report.diagnostics]
            (files[shape],) = (path for path in output.glob("*.xml") if not path.name.endswith(".scene.xml"))
            print(f"{sidecar.name}, {shape}: {shapes_of(output / 'report.json')}")
        print("\n".join(compare_steps(files, options.rounds)), flush=True)
    if written:
        print("\n".join(compare_steps({str(path): path for path in written}, options.rounds)), flush=True)


def _gym(options: argparse.Namespace, _: Path) -> None:
    for line in environment_speeds(options.model, options.task):
        print(line, flush=True)


def _batch(options: argparse.Namespace, folder: Path) -> None:
    case = Case(options.robots.stem, folder, folder, folder)
    robots = options.robots.resolve()
    contenders = [who.batch(1, robots), who.batch(2, robots)]
    if options.dask:
        contenders += [who.dask_batch(workers, robots) for workers in (1, 2, 4)]
    _compare(options, case, contenders)


def _memory(options: argparse.Namespace, folder: Path) -> None:
    copies = distinct_copies(options.robots.resolve(), options.count, folder / "copies")
    print(memory_table(batch_memory(copies, folder / "made", options.jobs)), flush=True)


def _scaling(options: argparse.Namespace, folder: Path) -> None:
    for kind, sizes in SCALES.items():
        for assembly in sizes if options.only in (None, kind) else ():
            count = assembly.definitions if kind == "definitions" else assembly.definitions * assembly.occurrences
            sidecar = generate(assembly, folder / "generated", f"{kind}-{count}")
            _compare(options, case_of(sidecar, None, folder), [who.BARE, who.COLD])


def _inference(options: argparse.Namespace, _: Path) -> None:
    sums = measure(corpus_folder(), options.only)
    if options.write:
        page = ROOT / "benchmarks" / "DRAFTS.md"
        page.write_text(page_with_table(page.read_text(encoding="utf-8"), sums), encoding="utf-8", newline="\n")


def _drafts(options: argparse.Namespace, _: Path) -> None:
    if (corpus := corpus_folder()) is None:
        raise SystemExit("the assemblies are in the corpus: see STEPBOT_CORPUS")
    scores = score_drafts(corpus, options.only, held_out=options.held_out)
    if options.calibration:
        print_calibration({name: one for outcomes in scores.values() for name, one in outcomes.items()})
    if options.write and not options.only:
        page = ROOT / "benchmarks" / "DRAFTS.md"
        page.write_text(page_with_scores(page.read_text(encoding="utf-8"), scores), encoding="utf-8", newline="\n")


def _drafting(options: argparse.Namespace, _: Path) -> None:
    assembly = read_for_inference(options.step)
    for copies in options.copies:
        print(drafting_time(assembly, copies), flush=True)


def _users(options: argparse.Namespace, folder: Path) -> None:
    sidecar = with_collision(drafted(options.files[0], folder / "drafts"), "hull", folder)
    measured = users.lines(options, sidecar, folder, lambda file, place: case_of(file, None, place))
    robot = options.files[0].name
    conditions = f"{machine()}; engines: {users.engines_here()}; the robot is `{robot}`, before is `{options.against}`."
    users.publish(measured, conditions, write=options.write)


def _gate(options: argparse.Namespace, folder: Path) -> int:
    """Exit code 1 if a job needs more processor time than the limit allows, 2 without a revision to compare with."""
    revision = "HEAD" if options.calibrate else options.against or gate.last_tag()
    if revision is None:
        print("no tag to compare with; name a revision: --against REVISION")
        return 2
    theirs = gate.source_of(revision, folder / "earlier")
    ours = gate.source_of(revision, folder / "same") if options.calibrate else gate.Source("working tree", ROOT)
    print(f"{ours.name} against {theirs.name}", flush=True)
    failed = False
    for number, sidecar in enumerate(GATED):
        ours_at, theirs_at = (
            case_of(sidecar, None, folder / side / sidecar.parent.name) for side in ("ours", "theirs")
        )
        for job in gate.jobs(sidecar.name, only_cold=number > 0):
            name = f"{sidecar.name.partition('.')[0]}: {job.name}"
            run = gate.ratios(job, ours, theirs, (ours_at, theirs_at))
            if options.calibrate:
                values = [run(number) for number in range(options.calibrate)]
                rates = gate.alarm_rates(values, CALIBRATED)
                words = ", ".join(f"{rate:.1%} at {factor:.3f}" for factor, rate in rates.items())
                print(f"{name:36} {median(values):.3f}, deviation {stdev(values):.3f}; fails: {words}", flush=True)
                continue
            verdict, values = gate.decided(run)
            failed |= verdict is gate.Verdict.FAILED
            print(gate.line(name, verdict, values), flush=True)
    return 1 if failed else 0


def _report(*_: object) -> None:
    write_report(ROOT / "docs")


def _smoke(_: argparse.Namespace, folder: Path) -> None:
    sidecar = generate(Assembly(definitions=3, occurrences=2), folder / "generated", "smoke")
    case = case_of(sidecar, None, folder)
    memory = Path("/proc/self/smaps_rollup").exists()
    for contenders in (
        [who.CLICK, who.VERSION, who.HELP, who.CHECK, who.UNCHANGED],
        [who.IN_TURN, who.AT_ONCE],
        [who.BARE, who.COLD, who.VERIFIED, who.EDITED, who.EDITED_VERIFIED, who.PLAIN, who.batch(2, sidecar.parent)],
    ):
        print(table(compare(case, contenders, 1, warm_up=False, memory=memory)), flush=True)


def drafted(step: Path, folder: Path) -> Path:
    """A sidecar that ``stepbot init`` drafts for a STEP file, beside a copy of it."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(step, folder / step.name)
    sidecar = folder / f"{step_stem(step.name)}.robot.yaml"
    command = [*who.STEPBOT, "init", step.name, "-o", sidecar.name, "--no-cache", "--force"]
    timed(command, folder, os.environ)
    return sidecar


def with_collision(sidecar: Path, shape: str, folder: Path) -> Path:
    """A copy of a sidecar with all shapes derived as ``shape``; no contact properties, which earlier versions lack."""
    text = _CONTACT.sub("", sidecar.read_text(encoding="utf-8"))
    named = NAMED.search(text)
    assert named is not None
    text = NAMED.sub(f"step: {json.dumps(str((sidecar.parent / named[1].strip()).resolve()))}", text)
    made = folder / shape / sidecar.name
    made.parent.mkdir(exist_ok=True)
    document = _DEFAULT_SHAPE.sub("", text).replace("defaults: {", f"defaults: {{collision: {shape}, ", 1)
    made.write_text(document, encoding="utf-8", newline="\n")
    return made


def case_of(sidecar: Path, step: Path | None, folder: Path) -> Case:
    """A case whose sidecar has a named frame to move."""
    text = sidecar.read_text(encoding="utf-8")
    named = NAMED.search(text)
    if step is None and named is None:
        raise SystemExit(f"{sidecar}: names no STEP")
    case = Case.of(sidecar, step or sidecar.parent / named[1], folder)
    copy = text if named is None else f"{text[: named.start(1)]}{case.step.name}{text[named.end(1) :]}"
    if "\nframes:" not in copy:
        link = _LINK.search(copy)
        if link is None:
            raise SystemExit(f"{sidecar}: no link found to put a frame on")
        copy = copy.rstrip("\n") + _PROBE.format(link=link[1])
    case.sidecar.write_text(copy, encoding="utf-8", newline="\n")
    return case


def _compare(options: argparse.Namespace, case: Case, contenders: Sequence[Contender]) -> None:
    rows = compare(case, contenders, options.rounds, warm_up=options.warm_up, memory=options.memory)
    print(f"\n{case.name}, medians of {options.rounds} rounds\n{table(rows)}", flush=True)
    if options.keep:
        keep(options.keep, case.name, rows, options.rounds)
