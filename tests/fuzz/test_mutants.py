"""Damaged STEP files give a valid assembly or an error with the reason: a sample of thousands."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.geometry.mesh import TriMesh
from stepbot.runtime.processes import core_count
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.step.assembly import Assembly, Body, BodyKind, Component
from tests.conftest import CORPUS_ABSENT, ROOT

from . import bases as base_files
from .forking import ForkServer, can_fork
from .judge import FAILED, judge, unsound
from .mutant import ALL_KINDS, KINDS, Mutant, plan
from .mutants import described, table, try_all
from .step_text import Edit, StepText

SMALL = 250_000
"""Size [bytes] of files whose mutants are tried by `make test`; `make test-long` and `make hostile` try all."""
forking = pytest.mark.skipif(not can_fork(), reason="processes cannot be forked safely here")


@pytest.fixture(scope="module")
def bases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the valid files, without those of the corpus if it is missing."""
    folder = tmp_path_factory.mktemp("bases")
    subprocess.run([sys.executable, "-m", "tests.fuzz.bases", str(folder)], cwd=ROOT, check=True)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(("origin", "count"), [("drawings", 8), pytest.param("corpus", 12, marks=pytest.mark.long)])
def test_mutants_find_no_fault(bases: Path, origin: str, count: int) -> None:
    """Mutants of small drawings and of real files raise no exception, do not crash, and give valid results."""
    if origin == "corpus" and base_files.absent():
        pytest.skip(CORPUS_ABSENT)
    names = [name for name in base_files.names(bases, real=origin == "corpus") if (bases / name).stat().st_size < SMALL]
    trials = list(try_all(plan(names, count, seed=1), bases, jobs=1))
    assert len(trials) == count
    failed = [trial for trial in trials if trial.verdict.faults]
    assert not failed, "\n".join(map(described, failed))
    assert {trial.verdict.outcome for trial in trials} >= {"robot", "refused"}, table(trials)


@pytest.mark.long
def test_two_hundred_mutants(bases: Path) -> None:
    """Two hundred mutants of every base and kind find no defect; benchmarks/READING.md has the numbers of all 2,000."""
    trials = list(try_all(plan(base_files.names(bases), 200, seed=2), bases, jobs=core_count()))
    failed = [trial for trial in trials if trial.verdict.faults]
    assert not failed, "\n".join(map(described, failed)) + table(trials)
    assert len(trials) == 200
    assert {trial.mutant.kind for trial in trials} >= set(KINDS)


# The mutants


@pytest.mark.slow
def test_a_mutant_is_made_from_its_name_alone(bases: Path) -> None:
    """A name gives the same bytes each time; other numbers give others; damage of every kind changes the file."""
    for kind in ALL_KINDS:
        mutants = [Mutant("box.step", kind, 1, number) for number in range(20)]
        contents = [mutant.content(bases) for mutant in mutants]
        assert contents == [Mutant.named(mutant.name).content(bases) for mutant in mutants]
        changed = set(contents) - {(bases / "box.step").read_bytes()}
        assert len(changed) > 10, kind


def test_every_damage_bears_any_file() -> None:
    """Damage applies to damaged files, down to empty ones."""
    from random import Random

    files = (b" ", b"DATA;", b"ISO-10303-21;DATA;#1=A();ENDSEC;", b"#1=#1;#2=B(#1,'x',1.,.T.,(1.,2.));", b"'" * 7)
    for kind, damage in KINDS.items():
        for data in files:
            for seed in range(50):
                assert isinstance(damage(StepText(data), Random(seed)), bytes), kind


def test_plan_takes_every_pair_once_before_any_twice() -> None:
    """Kinds and bases are equally frequent, in an order given by the seed."""
    count = 3 * len(ALL_KINDS)
    pairs = [(mutant.base, mutant.kind) for mutant in plan(["a", "b", "c"], count, 5)]
    assert len(set(pairs)) == count
    assert pairs != [(mutant.base, mutant.kind) for mutant in plan(["a", "b", "c"], count, 6)]


def test_unknown_kind_is_refused() -> None:
    """An unknown kind is reported with the available ones."""
    with pytest.raises(ValueError, match="truncation, bytes"):
        Mutant.named("box.step:nonsense:1:2")


def test_step_text_finds_statements_and_their_words() -> None:
    """Strings may contain references and ends of statements; edits keep all other bytes."""
    step = StepText(b"HEADER;FILE_NAME('#1=X;');DATA;\n#12 = LINE('a;#3''b',#4,-1.5E+03,.T.);\n#4=(A()B(*));")
    assert [(s.number, s.keyword) for s in step.statements] == [(12, b"LINE"), (4, b"A")]
    line = step.statements[0]
    assert [step.text(token) for token in step.within(line, "reference", "number", "enumeration")] == [
        b"#4",
        b"-1.5E+03",
        b".T.",
    ]
    (text,) = step.within(line, "string")
    assert step.edited([Edit(text.start, text.end, b"$")]) == step.data.replace(b"'a;#3''b'", b"$")


# The judge detects every forbidden outcome


def _box(**changes: object) -> Assembly:
    import trimesh

    mesh = trimesh.creation.box(extents=(0.1, 0.2, 0.3))
    faces = np.zeros(len(mesh.faces), dtype=np.int32)
    body = Body(BodyKind.SOLID, TriMesh.of(mesh.vertices, mesh.faces), faces, (None,), True)
    root = Component(0, -1, ".", ".", "block", "", 1, body=0)
    assembly = Assembly("box.step", "AP214", "", "mm", 1e-3, (root,), (body,))
    return replace(assembly, **changes)  # type: ignore[arg-type]


def test_judge_accepts_what_is_sound() -> None:
    """A valid assembly becomes the files of all formats; a rejection with a remedy is accepted."""
    verdict = judge(Path("box.step"), lambda step, found: _box())
    assert (verdict.outcome, verdict.faults) == ("robot", ())

    def refuse(step: Path, diagnostics: Diagnostics) -> None:
        diagnostics.add("SB201", "is not a STEP file", Span(str(step)), help=["export it"])

    assert judge(Path("box.step"), refuse).outcome == "refused"


def _raise(error: Exception) -> Callable[[Path, Diagnostics], None]:
    def read(step: Path, diagnostics: Diagnostics) -> None:
        raise error

    return read


def _say(code: str, message: str, *help: str, file: str = "box.step") -> Callable[[Path, Diagnostics], None]:
    def read(step: Path, diagnostics: Diagnostics) -> None:
        diagnostics.add(code, message, Span(file), help=help)

    return read


def _bring(diagnostic: Diagnostic) -> Callable[[Path, Diagnostics], None]:
    """Add a diagnostic as a worker does; `Diagnostics.add` rejects line breaks."""

    def read(step: Path, diagnostics: Diagnostics) -> None:
        diagnostics.extend([diagnostic])

    return read


def _warn(step: Path, diagnostics: Diagnostics) -> Assembly:
    np.float64(1e308) * np.float64(10.0)
    return _box()


@pytest.mark.parametrize(
    ("read", "fault"),
    [
        (_raise(RemoteError("KeyError", "x", "trace")), "RemoteError: KeyError"),
        (_raise(ZeroDivisionError("x")), "ZeroDivisionError"),
        (lambda step, found: None, "no assembly, and no error"),
        (_say("SB901", "met a state", "report it"), "internal error"),
        (_say("SB201", "is not a STEP file"), "no remedy"),
        (
            _bring(Diagnostic("SB201", "error", "two\nlines", Span("box.step"), ("export it",))),
            "not one printable line",
        ),
        (_say("SB201", "is not a STEP file", "export it", file=""), "no place"),
        (lambda step, found: _box(unit_scale=float("nan")), "a length unit of nan"),
        (_warn, "RuntimeWarning"),
    ],
)
def test_judge_finds_faults(read: Callable[[Path, Diagnostics], Assembly | None], fault: str) -> None:
    """Exceptions, missing errors or remedies, internal errors and numpy warnings are defects."""
    verdict = judge(Path("box.step"), read)
    assert verdict.outcome == FAILED
    assert fault in "\n".join(verdict.faults)


def test_invalid_assemblies_are_detected() -> None:
    """NaN, invalid indices and inconsistent meshes are defects."""
    sound = _box()
    assert not list(unsound(sound))
    body, root = sound.bodies[0], sound.components[0]
    mesh = body.mesh
    vertices = mesh.vertices.copy()
    vertices[0, 0] = np.inf
    damaged = [
        _box(components=()),
        _box(components=(replace(root, body=-1),)),
        _box(components=(replace(root, body=1),)),
        _box(components=(replace(root, density=-1.0),)),
        _box(components=(replace(root, color=(0.0, 2.0, 0.0, 1.0)),)),
        _box(components=(replace(root, product="\ud83d"),)),
        _box(components=(root, replace(root, index=1, parent=0))),
        _box(bodies=(replace(body, watertight=False),)),
        _box(bodies=(replace(body, face_colors=body.face_colors + 1),)),
        _box(bodies=(replace(body, mesh=TriMesh(vertices, mesh.faces)),)),
        _box(bodies=(replace(body, mesh=TriMesh(mesh.vertices, mesh.faces[:-1]), face_colors=body.face_colors[:-1]),)),
    ]
    for number, assembly in enumerate(damaged):
        assert list(unsound(assembly)), number


@pytest.mark.slow
def test_a_crash_of_stepbots_own_process_is_a_fault(tmp_path: Path) -> None:
    """A runner that dies is reported, named and replaced."""
    mutants = [Mutant("box.step", "bytes", 1, number) for number in range(4)]
    trials = {t.mutant.number: t.verdict for t in try_all(mutants, tmp_path, jobs=2, runner="tests.fuzz.broken_runner")}
    assert [trials[number].outcome for number in range(4)] == ["robot", FAILED, "robot", FAILED]
    assert "stepbot's own process ended with status" in trials[1].faults[0]


# The fork server answers, and fails, as a worker does


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[[str], ForkServer]]:
    """Starts fork servers of the functions for tests of isolation, and ends them."""
    servers: list[ForkServer] = []

    def start(name: str) -> ForkServer:
        folder = tmp_path / name
        folder.mkdir()
        servers.append(ForkServer(f"tests.unit.runtime.isolated_functions:{name}", folder, memory_limit=1 << 30))
        return servers[-1]

    yield start
    for server in servers:
        server.close()


@forking
def test_forked_calls_answer_again_and_again(serve: Callable[[str], ForkServer]) -> None:
    """One server answers many calls, each in its own process."""
    server = serve("double")
    assert [server.call(number).result(10.0) for number in range(5)] == [0, 2, 4, 6, 8]


@pytest.mark.slow
@forking
@pytest.mark.parametrize(
    ("name", "argument", "timeout", "reason"),
    [
        ("crash", "last words", 20.0, "killed by SIGSEGV"),
        ("leave", 3, 20.0, "ended with exit code 3"),
        ("sleep", 60.0, 0.5, "no result after 0.5 s"),
        ("allocate", 2 << 30, 20.0, "out of memory"),
    ],
)
def test_forked_calls_die_as_workers_do(
    serve: Callable[[str], ForkServer], name: str, argument: object, timeout: float, reason: str
) -> None:
    """A crash, an exit, a hang and too much memory each end one call, with the reason."""
    server = serve(name)
    for _ in range(2):
        with pytest.raises(WorkerDied) as died:
            server.call(argument).result(timeout)
        assert reason in died.value.reason


@forking
def test_exceptions_of_forked_calls_come_back(serve: Callable[[str], ForkServer]) -> None:
    """An exception in the function is raised by the call, with its traceback."""
    with pytest.raises(RemoteError, match="ValueError: no") as raised:
        serve("fail").call("no").result(10.0)
    assert "isolated_functions" in raised.value.trace
