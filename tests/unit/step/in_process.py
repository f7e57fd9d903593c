"""Reads STEP files within the test's process, so that the kernel is loaded once for all tests."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import Assembly, Component, ReadOptions
from stepbot.step.exchange.file_set import check_files


def read_here(path: Path, found: Diagnostics, options: ReadOptions | None = None) -> Assembly | None:
    """The assembly of a file, by the function that runs in the kernel's process."""
    from stepbot.step.worker import read

    options = options or ReadOptions()
    files = check_files(path, path.name, found, options.encoding)
    if files is None:
        return None
    assembly, diagnostics = read(files, options)
    found.extend(diagnostics)
    return assembly


def read_quietly(path: Path, options: ReadOptions | None = None) -> Assembly:
    """The assembly of a file without diagnostics except notes."""
    diagnostics = Diagnostics()
    assembly = read_here(path, diagnostics, options)
    assert [str(d) for d in diagnostics if d.severity != "note"] == []
    assert assembly is not None
    return assembly


def by_path(assembly: Assembly) -> dict[str, Component]:
    """Components by their canonical path, which is unique."""
    components = {component.path: component for component in assembly.components}
    assert len(components) == len(assembly.components)
    return components
