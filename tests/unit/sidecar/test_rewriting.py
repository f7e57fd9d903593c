"""Component paths are replaced in the text, and nothing else changes."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.rewriting import rewritten

HEAD = """\
version: 1
robot: arm
step: arm.step
"""


def rewrite(body: str, paths: dict[str, str], *, line_end: str = "\n") -> str | None:
    """A sidecar with other paths; None if it is rejected."""
    text = HEAD + body
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), diagnostics)
    assert sidecar is not None, list(map(str, diagnostics))
    new = rewritten(sidecar, text.replace("\n", line_end).encode(), paths)
    return None if new is None else new.decode().replace(line_end, "\n").removeprefix(HEAD)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("links: {a: {parts: [pin]}}\n", "links: {a: {parts: [bolt]}}\n"),
        ("links:\n  a:\n    parts:\n    - pin   # pin\n", "links:\n  a:\n    parts:\n    - bolt   # pin\n"),
        ("links: {a: {parts: ['pin', \"pin\"]}}\n", "links: {a: {parts: ['bolt', \"bolt\"]}}\n"),
        (
            "links: {a: {parts: [&p pin]}}\nparts: {pin: {mass: 1}}\n",
            "links: {a: {parts: [&p bolt]}}\nparts: {bolt: {mass: 1}}\n",
        ),
        ("links: {pin: {parts: [pin]}}\n", "links: {pin: {parts: [bolt]}}\n"),
        ("links: {a: {parts: [pins, pin, pin/x]}}\n", "links: {a: {parts: [pins, bolt, pin/x]}}\n"),
        (
            "links: {a: {}}\nframes: {f: {link: a, origin: {component: pin, offset: {xyz: [1, 2, 3]}}}}\n",
            "links: {a: {}}\nframes: {f: {link: a, origin: {component: bolt, offset: {xyz: [1, 2, 3]}}}}\n",
        ),
    ],
)
def test_names_alone_change(before: str, after: str) -> None:
    """Flow and block lists, quotes, anchors, comments and line ends are kept; a link of the same name is no path."""
    for line_end in ("\n", "\r\n", "\r"):
        assert rewrite(before, {"pin": "bolt"}, line_end=line_end) == after


@pytest.mark.parametrize(
    ("new", "written"),
    [
        ("a b", "a b"),
        ("gripper/finger-2", "gripper/finger-2"),
        ("gripper:1", '"gripper:1"'),
        ("true", '"true"'),
        ("12", '"12"'),
        ("x, y", '"x, y"'),
        ("#4", '"#4"'),
        ("**/x", '"**/x"'),
        ("a\\#1", '"a\\\\#1"'),
        ('say "x"', '"say \\"x\\""'),
        ("\u043f\u043b\u0438\u0442\u0430", "\u043f\u043b\u0438\u0442\u0430"),
    ],
)
def test_new_names_are_quoted_where_they_need_it(new: str, written: str) -> None:
    """A new name gets quotes if YAML requires them, and is read back unchanged."""
    assert (
        rewrite("links: {a: {parts: [pin, other]}}\n", {"pin": new}) == f"links: {{a: {{parts: [{written}, other]}}}}\n"
    )


def test_quotes_are_kept() -> None:
    """In single quotes an apostrophe is doubled."""
    assert rewrite("links: {a: {parts: ['pin']}}\n", {"pin": "it's"}) == "links: {a: {parts: ['it''s']}}\n"


def test_two_names_may_trade_places() -> None:
    """Two paths can be exchanged, since all are replaced at once."""
    body = "links: {a: {parts: [x#1, x#2]}}\n"
    assert rewrite(body, {"x#1": "x#2", "x#2": "x#1"}) == 'links: {a: {parts: ["x#2", "x#1"]}}\n'


@pytest.mark.parametrize(
    "body",
    [
        "links: {a: {parts: [pin]}}\nparts: {pin: {mass: 1}, bolt: {mass: 2}}\n",
        'links:\n  a:\n    parts:\n    - "pin\\\n      "\n',
    ],
)
def test_what_cannot_be_replaced_is_refused(body: str) -> None:
    """Two rules of one name, or a text over two lines, are rejected, and nothing is written."""
    assert rewrite(body, {"pin": "bolt"}) is None
