"""Edits STEP files for transcripts."""

import re
from pathlib import Path


def edited(path: Path, *changes: tuple[str, str], added: str = "") -> None:
    """Replace text of statements, one per line, and add statements."""
    text = re.sub(r"\n\s*", "", path.read_text(encoding="utf-8")).replace(";", ";\n")
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, count=1)
        assert count == 1, pattern
    before, after = text.rsplit("ENDSEC;", 1)
    path.write_text(f"{before}{added}ENDSEC;{after}", encoding="utf-8", newline="\n")
