"""Searches in foreign text take linear time."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from types import FrameType

import pytest

from stepbot.diagnostics import Diagnostics, did_you_mean
from stepbot.jobs.incremental import named_files
from stepbot.step.exchange import encodings, part21
from stepbot.step.exchange.part21_values import decode_string
from stepbot.step.exchange.references import external_references
from stepbot.step.exchange.statements import Statement, _long_tokens, duplicates, find_statements
from stepbot.step.structure import paths

pytestmark = [
    pytest.mark.skipif(os.name == "nt", reason="a search that does not end cannot be stopped there"),
    pytest.mark.slow,
]

SECONDS = 30.0
"""Processor time [s] after which a search counts as endless."""
SHORT, LONG = 1 << 16, 1 << 20
MOST = 4.0
"""Maximum ratio of the time for one long text to that for short ones of equal total length; quadratic is 16."""
TICK = 0.02
"""Processor time [s] below which differences are noise: Linux counts in steps of 4 to 10 ms while a timer runs."""
MEASURED = 5 * TICK
TRIES = 8
"""Other processes on the same cores empty the caches, which slows long texts down; quadratic time passes no try."""


@pytest.fixture(autouse=True)
def stopwatch() -> Iterator[None]:
    """Stop a search that does not end."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"no end after {SECONDS:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    signal.signal(signal.SIGPROF, before)


def check(data: bytes) -> None:
    """Check a STEP file without the kernel."""
    part21._check(data, "", "foreign.step", Diagnostics())


def header(data: bytes) -> None:
    """Parse the header."""
    part21._read_header(data, "ascii")


def documents(data: bytes) -> None:
    """Find the files that a STEP file refers to."""
    external_references(data, "ascii")


def names(data: bytes) -> None:
    """Find file names in an unchecked STEP file with one entity per line."""
    rows = (b"#%d=DOCUMENT_FILE('a%d.step','',$,$,'',$);" % (i, i) for i in range(1, len(data) // 40))
    assert external_references(b"\n".join(rows), "", with_products=False)


def products(data: bytes) -> None:
    """Find the documents of a formation with many product definitions, and as many references to it."""
    count = len(data) // 160
    rows = [b"#1=PRODUCT_DEFINITION_FORMATION('','',$);"]
    for i in range(2, 3 * count, 3):
        rows.append(b"#%d=PRODUCT_DEFINITION('','',#1,$);" % i)
        rows.append(b"#%d=DOCUMENT_FILE('a%d.step','',$,$,'',$);" % (i + 1, i))
        rows.append(b"#%d=APPLIED_DOCUMENT_REFERENCE(#%d,'',(#1));" % (i + 2, i + 1))
    assert external_references(b"\n".join(rows), "", with_products=False)


def numbers(data: bytes) -> None:
    """Search for duplicate entity numbers."""
    duplicates(data)


def statements(data: bytes) -> None:
    """Split the text into statements."""
    list(find_statements(data))


def long_tokens(data: bytes) -> None:
    """Find strings and comments that are too long."""
    list(_long_tokens(data))


def references(data: bytes) -> None:
    """Find the references in a statement."""
    statement = Statement(1, 0, data)
    assert statement.keyword is not None
    list(statement.references)


def sample(data: bytes) -> None:
    """Find the first name that is not ASCII."""
    encodings._first(data, "cp1252")


def string(data: bytes) -> None:
    """Decode a string."""
    decode_string(data, "ascii")


def glob(data: bytes) -> None:
    """Match a name with a pattern of many stars."""
    assert not paths._parse_segment("*a" * 20 + "*b").accepts(data.decode())


def file_names(data: bytes) -> None:
    """Find names of files in a sidecar or a description."""
    named_files(data)


def spelling(data: bytes) -> None:
    """Find a candidate for a misspelt name."""
    text = data.decode()
    did_you_mean(text, [f"x{text}"])


MORE: list[tuple[Callable[[bytes], None], bytes]] = [
    (check, b" "),
    (check, b"ISO-10303-21;DATA "),
    (header, b"''"),
    (documents, b"DOCUMENT_FILE"),
    (documents, b"DOCUMENT_FILE(''"),
    (documents, b"DOCUMENT_FILE('a',"),
    (numbers, b";#0"),
    (numbers, b"; "),
    (numbers, b";# "),
    (numbers, b";#1 "),
    (statements, b"#1=/*a*/"),
    (statements, b"#1="),
    (statements, b"#1"),
    (statements, b"# "),
    (long_tokens, b"''"),
    (long_tokens, b"/**/"),
    (references, b"1"),
    (sample, b"\xe9"),
    (string, b" "),
    (string, b"\n "),
]
"""Texts that the same expressions read as those below, in other places."""


@pytest.mark.parametrize(
    ("function", "unit"),
    [
        (check, b"/*a*/"),
        (check, b"/* "),
        (header, b"/* "),
        (header, b"A('"),
        (documents, b"DOCUMENT_FILE('"),
        (documents, b"DOCUMENT_FILE( '''' , '''"),
        (names, b"x"),
        (products, b"x"),
        (numbers, b";#1"),
        (numbers, b";#1=A('"),
        (statements, b"#1=/* "),
        (statements, b"#1='"),
        (statements, b"#1=A(/**/'/*'/*'*/);"),
        (long_tokens, b"' "),
        (long_tokens, b"/* "),
        (references, b"#1/* "),
        (references, b"# '"),
        (sample, b"'\xe9"),
        (sample, b"'"),
        (string, b"\\X2\\00"),
        (string, b"\\X2\\"),
        (glob, b"a"),
        (spelling, b"ab"),
        (file_names, b"<a>1</a>"),
        (file_names, b"a.yaml.b "),
        *(pytest.param(*each, marks=pytest.mark.long) for each in MORE),
    ],
)
def test_time_grows_with_the_length(function: Callable[[bytes], None], unit: bytes) -> None:
    """One text takes less than four times as long as its sixteen parts; quadratic time is sixteen times as long."""
    # Strings in a header take five times as long per byte from 1 MB, and no longer at 16 MB: the expression's stack.
    scale = LONG // SHORT if (function, unit) == (header, b"''") else 1
    texts = [
        (b"'" + unit * (size // len(unit)) if function is sample else unit * (size // len(unit)))
        for size in (SHORT * scale, LONG * scale)
    ]
    measured = []
    for _ in range(TRIES):
        short, long = _times(function, *texts)
        if long < MOST * max(short, TICK):
            return
        measured.append(f"{long:.3g} s instead of {short:.3g} s")
    pytest.fail("; ".join(measured))


def _times(function: Callable[[bytes], None], short: bytes, long: bytes) -> tuple[float, float]:
    """Processor time [s] for short and for long texts of equal total length, repeated until measurable."""
    times = [0.0, 0.0]
    for _ in range(20):
        for number, (text, count) in enumerate(((short, LONG // SHORT), (long, 1))):
            start = time.process_time()
            for _ in range(count):
                function(text)
            times[number] += time.process_time() - start
        if max(times) > MEASURED:
            break
    return times[0], times[1]


def test_square_is_noticed() -> None:
    """The test fails for a search that restarts at each position."""

    def search(data: bytes) -> None:
        for start in range(0, len(data), 256):
            data.endswith(data[start:])

    with pytest.raises(pytest.fail.Exception, match="instead of"):
        test_time_grows_with_the_length(search, b"a")
