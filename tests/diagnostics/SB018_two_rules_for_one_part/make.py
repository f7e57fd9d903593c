"""A part renamed to the name in another rule that matched nothing."""

from pathlib import Path

import pytest

from tests.revisions import LEVER, write_locked_lever


def make(patch: pytest.MonkeyPatch) -> None:
    """Set it up."""
    rules = "parts: {motor: {mass: 50 g}, XL430: {mass: 57 g}}\n"
    # A rule for a part that is not there yet is an error of its own; the lock is older than the rule.
    revision = write_locked_lever(sidecar=LEVER + "parts: {motor: {mass: 50 g}}\n")
    revision.rename({"motor": "XL430", "motor:1": "XL430:1"}).write(Path("lever.step"))
    Path("lever.robot.yaml").write_text(LEVER + rules, encoding="utf-8")
