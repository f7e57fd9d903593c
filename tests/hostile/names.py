"""Parts and robots with hostile names: paths, escape sequences, markup, devices, names that differ only in case.

Each name is given to two products (the second in the other case) and their occurrences, all in one assembly; then to a
robot, its links and a material.
"""

import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec import Struct, field
from msgspec.structs import replace

from robot_library.step_file import Assembly, Occurrence, write_step
from stepbot.robot.mesh_names import is_device
from tests.command_line import snapshot
from tests.parts import box, drawn

from .command import Ended, stepbot
from .experiment import Experiment, Setting, Trial

_PLACE = "@PLACE@"
"""Placeholder for the folder of a trial, in which no file may be added."""
_HEAD = "version: 1\nmaterials: {steel: {density: 7850 kg/m^3}}\ndefaults: {material: steel}\n"
_RLO, _PDF = "\u202e", "\u202c"


class Case(Struct, frozen=True):
    """A name."""

    name: str
    text: str
    is_raw: bool = False
    """Whether the STEP contains its bytes unchanged, instead of the directives of ISO 10303-21."""

    def placed(self, place: Path) -> "Case":
        """The case with the folder of a trial in place of the placeholder."""
        return replace(self, text=self.text.replace(_PLACE, str(place)))


CASES = (
    Case("window_title", "\x1b]0;title\x07arm"),
    Case("parent_folders", "../../../arm"),
    Case("differ_in_case", "Arm"),
    Case("device", "CON"),
    Case("markup", "</robot><!-- ]]> &lt; \"a\" 'b' %s {0} -->"),
    Case("absolute", f"{_PLACE}/arm"),
    Case("windows_path", "C:\\Windows\\..\\arm"),
    Case("alternate_stream", "arm:stream"),
    Case("nul", "arm\0.obj"),
    Case("line_break", "arm\r\nerror[SB999]: forged"),
    Case("colours", "\x1b[38;5;201marm\x1b[2J\x1b[H"),
    Case("raw_escape", "\x1b[38;5;201marm\x1b]8;;http://127.0.0.1:9\x07", is_raw=True),
    Case("c1_controls", "\x9b2Jarm\x9d0;title\x9c\x85"),
    Case("clipboard", "\x1b]52;c;cm0gLXJmIH4=\x07\x1bP+q\x1b\\"),
    Case("bidi", f"arm{_RLO}jbo.exe{_PDF}\u2066x\u2069"),
    Case("line_separators", "arm\u2028error\u2029forged"),
    Case("zero_width", "a\u200brm\ufeff\u2060"),
    Case("combining", "a" + "\u0301" * 200),
    Case("noncharacters", "arm\ufffe\uffff"),
    Case("device_with_suffix", "nul.obj"),
    Case("device_superscript", "LPT\u00b9"),
    Case("trailing", "arm. . ."),
    Case("dots", ".."),
    Case("blank", " \t "),
    Case("sharp_s", "stra\u00dfe"),
    Case("dotless_i", "\u0130\u0131"),
    Case("long", "arm" * 3_400),
    Case("long_astral", "\U0001f9be" * 400),
    Case("glob", "**/*#1"),
    Case("shell", "-rf $(touch x) `id` ; | & ~ !"),
    Case("manifest", ".stepbot.json"),
    Case("world", "world"),
)
"""Those of the short form first."""

_TERMINAL = (sys.executable, "-c", "import os, pty, sys; sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))")
"""A command that runs another one on a terminal of its own and copies its output."""
_OWN_SEQUENCE = re.compile(r"\x1b\[([0-9]{1,2};?)*m|\x1b\[\?25[hl]|\x1b\[[0-9]?[AKJ]|\r")
"""Colours and progress bar of stepbot."""


def run(setting: Setting) -> Iterator[Trial]:
    """Give all names to parts of one assembly, then each to a robot; inspect output and files."""
    for number in range(setting.count):
        place = setting.folder / f"trial{number}"
        (place / "a" / "b").mkdir(parents=True)
        trial = _Trial(place, setting.folder / "cache")
        if number == 0:
            outcome = _parts(trial, [case.placed(place) for case in CASES])
            name = "parts"
        else:
            case = CASES[number - 1]
            outcome, name = _robot(trial, case.placed(place)), f"robot:{case.name}"
        yield Trial(name, outcome, tuple(trial.faults))


class _Trial(Struct):
    """Commands run in a folder, and the defects found."""

    place: Path
    cache: Path
    faults: list[str] = field(default_factory=list)

    @property
    def folder(self) -> Path:
        """The folder with the input."""
        return self.place / "a" / "b"

    def run(self, *command: str, codes: tuple[int, ...], on_terminal: bool = False) -> Ended:
        """Run a command."""
        wrapper = _TERMINAL if on_terminal else ()
        options = ("--cache", self.cache)
        ended = stepbot(*command, *options, folder=self.folder, temporary=self.place / "tmp", wrapper=wrapper)
        shown = _OWN_SEQUENCE.sub("", ended.text) if on_terminal else ended.text
        found = [*ended.faults(codes), *_raw_controls(shown)]
        self.faults.extend(f"{' '.join(command)[:80]}: {fault}" for fault in found)
        return ended

    def files(self) -> set[str]:
        """All files except temporary ones."""
        return {path for path in snapshot(self.place) if not path.startswith("tmp/")}

    def look_at_added(self, before: set[str]) -> set[str]:
        """Inspect added files; returns those in the output folder."""
        added = self.files() - before
        written = {path.removeprefix("a/b/out/") for path in added if path.startswith("a/b/out/")}
        outside = sorted(path for path in added if not path.startswith("a/b/out/"))
        self.faults += [f"writes '{path}' outside of its output folder" for path in outside]
        self.faults += _bad_file_names(written)
        return written


def _parts(trial: _Trial, cases: Sequence[Case]) -> str:
    """Inspect, check and convert an assembly whose parts have the names, each also in the other case."""
    _write_step(trial.folder / "part.step", cases)
    sound = f"{_HEAD}step: part.step\nrobot: sound\nlinks: {{base: {{parts: ['**']}}}}\n"
    near = ("".join(c for c in f"{case.text}x" if c.isprintable() and c not in "*#") for case in cases)
    wrong = f"{_HEAD}step: part.step\nrobot: wrong\nlinks: {{base: {{parts: [{', '.join(map(_yaml, near))}]}}}}\n"
    (trial.folder / "sound.robot.yaml").write_text(sound, encoding="utf-8")
    (trial.folder / "wrong.robot.yaml").write_text(wrong, encoding="utf-8")
    before = trial.files()
    trial.run("inspect", "part.step", "--features", "-v", codes=(0,), on_terminal=True)
    trial.run("inspect", "part.step", "--json", codes=(0,))
    trial.run("inspect", "part.step", "--between", "armx", "\x1b]0;title\x07ar", codes=(2,), on_terminal=True)
    trial.run("check", "wrong.robot.yaml", "--step", "part.step", "-v", codes=(1,), on_terminal=True)
    trial.run("check", "wrong.robot.yaml", "--step", "part.step", "--json", codes=(1,))
    trial.run("convert", "sound.robot.yaml", "-o", "out", "--no-verify", codes=(0,), on_terminal=True)
    written = trial.look_at_added(before)
    meshes = sum(path.endswith(".obj") for path in written)
    if meshes < len(cases):
        trial.faults.append(f"{meshes} meshes of {len(cases)} parts and more")
    return f"robot of {len(cases)} parts"


def _robot(trial: _Trial, case: Case) -> str:
    """Check and convert a robot of this name, with a link and a material of the same name."""
    _write_step(trial.folder / "plain.step", (Case("", "part"),))
    name, other = _yaml(case.text), _yaml(f"{case.text.swapcase()}_"[-200:])
    named = (
        f"version: 1\nstep: plain.step\nrobot: {name}\nbase: fixed\n"
        f"materials: {{{name}: {{density: 7850 kg/m^3}}}}\ndefaults: {{material: {name}}}\n"
        f"links:\n  {name}: {{parts: [part]}}\n  {other}: {{parts: [PART]}}\n"
        f"joints: {{turn: {{type: fixed, parent: {name}, child: {other}, origin: {{center: part}}}}}}\n"
    )
    (trial.folder / "named.robot.yaml").write_text(named, encoding="utf-8")
    before = trial.files()
    shown = trial.run("check", "named.robot.yaml", codes=(0, 1), on_terminal=True)
    checked = trial.run("check", "named.robot.yaml", "--json", codes=(shown.code,))
    codes = set(re.findall(r"\bSB\d{3}\b", checked.text))
    if checked.code and not codes & {"SB102", "SB126"}:
        trial.faults.append(f"refused, but not for its name: {', '.join(sorted(codes))}")
    if checked.code == 0:
        trial.run("convert", "named.robot.yaml", "-o", "out", codes=(0,), on_terminal=True)
    trial.look_at_added(before)
    return "refused" if checked.code else "robot"


def _raw_controls(shown: str) -> list[str]:
    """Control characters in output that could steer a terminal or forge a line."""
    controls = sorted({f"U+{ord(c):04X}" for c in shown if not c.isprintable() and c != "\n"})
    found = [f"prints {', '.join(controls)} as they are"] if controls else []
    if any(line.startswith("error[SB999]") for line in shown.splitlines()):
        found.append("prints a line that the name forges")
    return found


def _bad_file_names(paths: set[str]) -> list[str]:
    """Names that are invalid on some system, or that denote one file on some."""
    found, first = [], dict[str, str]()
    for path in sorted(paths):
        other = first.setdefault(path.casefold(), path)
        if other != path:
            found.append(f"'{other}' and '{path}' are one file on some systems")
        for part in path.split("/"):
            is_bad = re.search(r'[\x00-\x1f\x7f<>:"|?*\\]|[. ]$', part) or not part.isprintable() or is_device(part)
            if is_bad or len(part.encode()) > 255:
                found.append(f"{part[:80]!r} is no name of a file on every system")
    return found


def _write_step(path: Path, cases: Sequence[Case]) -> None:
    """Two boxes for each name, one of them in the other case; products, occurrences and the assembly have the names."""
    children, names = [], dict[str, str]()
    for number, case in enumerate(cases):
        for other, text in enumerate((case.text, case.text.swapcase())):
            mark = f"PLACE_{number}_{other}_"
            solid = box(10 + number, 20 + other, 30).at(50 * number, 50 * other, 0)
            children.append(Occurrence(drawn(mark, solid), f"{mark}:1"))
            names[mark] = _escaped(text, case.is_raw)
    write_step(path, Assembly(children[0].product.name, children))
    content = path.read_text(encoding="ascii")
    path.write_text(re.sub(r"PLACE_\d+_\d_", lambda mark: names[mark[0]], content), encoding="utf-8", newline="")


def _escaped(text: str, is_raw: bool) -> str:
    r"""A text as written in a STEP file: quotes and backslashes doubled, ``\X4\`` for non-ASCII characters."""
    quoted = text.replace("\\", "\\\\").replace("'", "''")
    return quoted if is_raw else re.sub(r"[^ -~]", lambda c: rf"\X4\{ord(c[0]):08X}\X0" + "\\", quoted)


def _yaml(text: str) -> str:
    """A text in double quotes, with escapes for everything except plain ASCII."""
    return '"' + "".join(c if c.isalnum() and c.isascii() else f"\\U{ord(c):08X}" for c in text) + '"'


EXPERIMENT = Experiment(
    "names",
    "parts, robots and links named like paths, devices, markup, escape sequences, each other in the other case",
    "no control character on the screen; files in the output folder alone, with names that each system can hold and "
    "tell apart; a robot, or SB126 where the name is the robot's own",
    run,
    short=3,
    long=1 + len(CASES),
    repaired=(
        "a robot could be called `CON`, `nul` or `LPT1`, a device on Windows whatever the extension (SB126)",
        "names of robots and links could hold characters that change the direction of text (SB126)",
        "names of robots and links could hold characters without width, and so look like others (SB126)",
        "errors about arguments printed escape sequences of these, and of names in the STEP that are near to them",
    ),
)
