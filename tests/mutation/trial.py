"""Robots with one removal in a file: which engines detect it."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from random import Random

from msgspec import Struct

from stepbot.robot.model import Robot
from tests.simulators.conftest import Folder, write

from .judge import Judge, question
from .removal import Removal, removals


class Verdict(Struct, frozen=True):
    """The outcome of a removal."""

    robot: str
    format: str
    removal: Removal
    noticed: str
    """Which engine detected what; empty if none did."""
    readers: tuple[str, ...]
    """The engines that read the unchanged file."""


class Flawed(Exception):
    """An engine reports a defect in the unchanged file, so that its reports on removals mean nothing."""


def verdicts(
    robots: Mapping[str, Callable[[], Robot]],
    judges: Mapping[str, Sequence[str]],
    folder: Path,
    of_each: int | None = None,
) -> Iterator[Verdict]:
    """Remove every element and every attribute of every file that some engine reads, one at a time.

    Args:
        robots: The robots by name.
        judges: The engines that check a format, in this order.
        folder: Folder for the files.
        of_each: Number of random removals tried per file, the same in every run; None for all.

    Raises:
        Flawed: An engine rejects an unchanged file.
    """
    for name, build in robots.items():
        written = write(build(), folder / name)
        for format_ in (one for one in judges if one in written.written):
            yield from _of_file(name, format_, written, judges[format_], of_each)


def _of_file(name: str, format_: str, folder: Folder, engines: Sequence[str], of_each: int | None) -> Iterator[Verdict]:
    path = folder.written[format_].path
    asked = question(folder.request(format_))
    expected = folder.expected(format_, asked)
    with ExitStack() as stack:
        judges = [stack.enter_context(Judge(engine, asked, expected)) for engine in engines]
        wrong = [f"{judge.engine}: {answer}" for judge in judges if (answer := judge.look_at_right(str(path)))]
        if wrong:
            raise Flawed(f"{path.name}: {'; '.join(wrong)}")
        readers = tuple(judge.engine for judge in judges if judge.reads)
        if not readers:
            return
        beside = path.with_name(f"less_{path.name}")  # in the same folder, where its meshes are found too
        for removal in _drawn(list(removals(path.read_bytes(), format_)), of_each, f"{name}/{format_}"):
            beside.write_bytes(removal.content)
            yield Verdict(name, format_, removal, _noticed(judges, beside), readers)


def _drawn(all_: list[Removal], of_each: int | None, seed: str) -> list[Removal]:
    if of_each is None or of_each >= len(all_):
        return all_
    chosen = sorted(Random(seed).sample(range(len(all_)), of_each))
    return [all_[index] for index in chosen]


def _noticed(judges: Iterable[Judge], file: Path) -> str:
    """The first judge that detects the removal, and its report."""
    for judge in judges:
        answer = judge.look_at(str(file))
        if answer:
            return f"{judge.engine}: {answer}"
    return ""
