"""``python -m tests.diagnostics.update [SBnnn...]`` rewrites the expected files of some transcripts, or of all."""

import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.diagnostics.transcripts import Stage, folders, missing_engines
from tests.warm import warm_processes


def update(codes: list[str]) -> Iterator[str]:
    """Rewrite the expected files of some codes; yields a line for each that changed or was skipped."""
    with TemporaryDirectory(prefix="stepbot-transcripts-") as scratch, warm_processes():
        stage = Stage(Path(scratch))
        for folder in folders():
            if not codes or folder.name[:5] in codes or folder.name in codes:
                yield from _update(folder, stage)


def _update(folder: Path, stage: Stage) -> Iterator[str]:
    if missing := missing_engines(folder):
        yield f"{folder.name}: skipped, {'; '.join(missing)}"
        return
    now = stage.transcript(folder)
    for name, text in (("expected.json", now.json), ("expected.txt", now.text)):
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")
            yield f"{folder.name}/{name}: written"
    if folder.name[:5] not in now.codes:
        yield f"{folder.name}: does not cause {folder.name[:5]}, but {', '.join(sorted(now.codes)) or 'nothing'}"


if __name__ == "__main__":
    for line in update(sys.argv[1:]):
        print(line, flush=True)  # noqa: T201
