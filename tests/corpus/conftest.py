"""Real assemblies, each read once for all tests with measuring meshes; deviations are printed at the end."""

import os
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.corpus.files import CorpusFile
from tests.corpus.reading import DEVIATIONS, ReadFile, read_file


@pytest.fixture(scope="session")
def read(corpus: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[CorpusFile], ReadFile]:
    """Read a file of the corpus in the kernel's process, or return the result of another test or process."""
    base = tmp_path_factory.getbasetemp()
    # Processes that share the tests have sibling folders.
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "corpus-readings"
    folder.mkdir(exist_ok=True)

    def read(file: CorpusFile) -> ReadFile:
        kept = folder / f"{file.stem}.pickle"
        if kept.exists():
            content: ReadFile = pickle.loads(kept.read_bytes())
            return content
        content = read_file(corpus / file.name)
        mine = kept.with_suffix(f".{os.getpid()}")
        mine.write_bytes(pickle.dumps(content))
        mine.replace(kept)
        return content

    return read


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print file, solid and deviation with ``-v``, else the worst deviation of each file."""
    rows = [
        row
        for report in terminalreporter.getreports("passed") + terminalreporter.getreports("failed")
        for name, value in report.user_properties
        if name == DEVIATIONS and report.when == "call"
        for row in value
    ]
    if not rows:
        return
    verbose = terminalreporter.config.get_verbosity() > 0
    terminalreporter.section("deviation of meshes from exact solids, of volume, com or inertia, whichever is worst")
    terminalreporter.line(f"{'written':>9} {'of':<8} {'measuring':>9} {'of':<8} {'taken':<6} file, solid")
    for file in dict.fromkeys(row[0] for row in rows):
        of_file = [row for row in rows if row[0] == file]
        for row in of_file if verbose else [max(of_file, key=lambda row: row[2])]:
            terminalreporter.line(
                f"{row[2]:9.1e} {row[3]:<8} {row[4]:9.1e} {row[5]:<8} {row[6]:<6} {file}, {row[1]}"
                + ("" if verbose else f", the worst of {len(of_file)}")
            )
