"""Foreign text takes time in proportion to its length: no search in it is quadratic, and none is exponential."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from types import FrameType

import pytest

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.step.exchange import encodings, part21
from stepbot.step.exchange.statements import Statement, find_statements
from stepbot.step.exchange.strings import decode_string
from stepbot.step.structure import paths

pytestmark = pytest.mark.skipif(os.name == "nt", reason="a search that does not end cannot be stopped there")

SECONDS = 30.0
"""Of processor time, after which a search is taken for endless."""
SHORT, LONG = 1 << 18, 1 << 20


@pytest.fixture(autouse=True)
def stopwatch() -> Iterator[None]:
    """Stops what does not come back."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"no end after {SECONDS:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    signal.signal(signal.SIGPROF, before)


def check(data: bytes) -> None:
    """What is told of a STEP file without the kernel."""
    part21._check(data, "", "foreign.step", Diagnostics())


def header(data: bytes) -> None:
    """The header's entities."""
    part21._read_header(data, "ascii")


def documents(data: bytes) -> None:
    """Files that a STEP file refers to."""
    part21._has_geometry(data, 0, "ascii", "foreign.step", Diagnostics())


def statements(data: bytes) -> None:
    """Statements of the text."""
    list(find_statements(data))


def references(data: bytes) -> None:
    """References of one statement."""
    statement = Statement(1, 0, data)
    assert statement.keyword is not None
    list(statement.references)


def sample(data: bytes) -> None:
    """The first name that is not ASCII."""
    encodings._first(data, "cp1252")


def string(data: bytes) -> None:
    """The text of a string."""
    decode_string(data, "ascii")


def glob(data: bytes) -> None:
    """A name and a pattern with many stars."""
    assert not paths._parse_segment("*a" * 20 + "*b").accepts(data.decode())


def spelling(data: bytes) -> None:
    """A misspelt name and one that is nearly it."""
    text = data.decode()
    did_you_mean(text, [f"x{text}"])


@pytest.mark.parametrize(
    ("function", "unit"),
    [
        (check, b"/*a*/"),
        (check, b"/* "),
        (check, b" "),
        (check, b"ISO-10303-21;DATA "),
        (header, b"/* "),
        (header, b"''"),
        (header, b"A('"),
        (documents, b"DOCUMENT_FILE"),
        (documents, b"DOCUMENT_FILE('"),
        (documents, b"DOCUMENT_FILE(''"),
        (documents, b"DOCUMENT_FILE('a',"),
        (documents, b"DOCUMENT_FILE( '''' , '''"),
        (statements, b"#1=/*a*/"),
        (statements, b"#1=/* "),
        (statements, b"#1="),
        (statements, b"#1"),
        (statements, b"#1='"),
        (statements, b"# "),
        (statements, b"#1=A(/**/'/*'/*'*/);"),
        (references, b"#1/* "),
        (references, b"1"),
        (references, b"# '"),
        (sample, b"'\xe9"),
        (sample, b"\xe9"),
        (sample, b"'"),
        (string, b" "),
        (string, b"\n "),
        (string, b"\\X2\\00"),
        (string, b"\\X2\\"),
        (glob, b"a"),
        (spelling, b"ab"),
    ],
)
def test_time_grows_with_the_length(function: Callable[[bytes], None], unit: bytes) -> None:
    """Four times the text takes less than ten times as long, where the square of it would take sixteen."""
    texts = [
        (b"'" + unit * (size // len(unit)) if function is sample else unit * (size // len(unit)))
        for size in (SHORT, LONG)
    ]
    ratios = []
    for _ in range(5):
        times = []
        for text in texts:
            start = time.process_time()
            function(text)
            times.append(time.process_time() - start)
        ratios.append(times[1] / max(times[0], 1e-3))
        if ratios[-1] < 10.0:
            return
    assert min(ratios) < 10.0, ratios
