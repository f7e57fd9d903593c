"""Changes of Python source, one at a time: another operator, number, condition or result, a call that is left out.

mutmut and cosmic-ray are the kept tools for this. Neither fits: the first one replaces functions within the process of
the tests, and stepbot's workers import the unchanged source; the second one runs one command for every change, and the
whole suite takes minutes.
"""

import ast
from collections.abc import Iterator
from itertools import pairwise

from msgspec import Struct

_COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
}
_OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.Mod: ("%", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Pow: ("**", "*"),
    ast.MatMult: ("@", "*"),
}


class Change(Struct, frozen=True):
    """One change of a file."""

    path: str
    """The file, relative to the project."""
    start: int
    end: int
    """Bytes that are replaced."""
    text: str
    line: int
    before: str
    """The text that is replaced, for people."""

    @property
    def name(self) -> str:
        """``path:line: before -> after``."""
        return f"{self.path}:{self.line}: `{_short(self.before)}` -> `{_short(self.text)}`"

    def apply(self, source: bytes) -> bytes:
        """The changed file."""
        return source[: self.start] + self.text.encode() + source[self.end :]


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) < 60 else line[:57] + "..."


def changes(path: str, source: bytes) -> list[Change]:
    """All changes of a file, in order. Annotations, messages and assertions stay: ``strict`` and ``frozen``, too."""
    lines = [0]
    for line in source.splitlines(keepends=True):
        lines.append(lines[-1] + len(line))

    def change(start: int, end: int, text: str) -> Change:
        return Change(path, start, end, text, source.count(b"\n", 0, start) + 1, source[start:end].decode())

    def span(node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return lines[node.lineno - 1] + node.col_offset, lines[node.end_lineno - 1] + node.end_col_offset

    def between(left: ast.expr, right: ast.expr, old: str, new: str) -> Iterator[Change]:
        start, end = span(left)[1], span(right)[0]
        at = source.find(old.encode(), start, end)
        if at >= 0:
            yield change(at, at + len(old), new)

    def of(node: ast.AST) -> Iterator[Change]:
        if isinstance(node, ast.Compare):
            for (left, right), operator in zip(pairwise([node.left, *node.comparators]), node.ops, strict=True):
                yield from between(left, right, *_COMPARISONS[type(operator)])
        elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            yield from between(node.left, node.right, *_OPERATORS[type(node.op)])
        elif isinstance(node, ast.BoolOp):
            old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
            for left, right in pairwise(node.values):
                yield from between(left, right, old, new)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
            start = span(node)[0]
            yield change(start, start + (3 if isinstance(node.op, ast.Not) else 1), "")
        elif isinstance(node, ast.Constant) and type(node.value) in (bool, int, float):
            yield change(*span(node), _other(node.value))
        elif isinstance(node, ast.If | ast.IfExp | ast.While):
            start, end = span(node.test)
            yield change(start, end, f"not ({source[start:end].decode()})")
        elif isinstance(node, ast.Return) and node.value is not None and not _is_false(node.value):
            yield change(*span(node.value), "None")
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            yield change(*span(node), "...")
        elif isinstance(node, ast.AugAssign) and type(node.op) in _OPERATORS:
            old, new = _OPERATORS[type(node.op)]
            yield from between(node.target, node.value, f"{old}=", f"{new}=")

    return sorted(
        (one for node in _judged(ast.parse(source)) for one in of(node)), key=lambda one: (one.start, one.end)
    )


def _judged(node: ast.AST) -> Iterator[ast.AST]:
    """A node and those below it that can change what the program does."""
    if isinstance(node, ast.Assert | ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        return
    if isinstance(node, ast.keyword) and node.arg in ("frozen", "strict"):
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _judged(child)


def _other(value: float) -> str:
    if isinstance(value, bool):
        return repr(not value)
    if isinstance(value, int):
        return repr(value + 1)
    return repr(value * 2.0 if value else 1.0)


def _is_false(node: ast.expr) -> bool:
    """Whether a result is None or False, for which None makes no difference to callers."""
    return isinstance(node, ast.Constant) and (node.value is None or node.value is False)
