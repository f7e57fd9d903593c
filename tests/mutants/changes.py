"""Small changes of source text, one at a time: what a slip of an author looks like."""

import ast
import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_SWAPPED: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div,),
    ast.Div: (ast.Mult,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
}
_FACTORS = (0.0, 2.5, 0.9)


@dataclass(frozen=True)
class Mutant:
    """One change of one file."""

    file: str
    """Path relative to the checkout."""
    line: int
    function: str
    """Name of the innermost function around it; empty at the top of the module."""
    first_line: int
    """First line of this function, or 0."""
    start: int
    """Offset [bytes] of the replaced text."""
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line} ({self.function or 'module'}): `{self.old}` -> `{self.new}`"

    def applied(self, text: bytes) -> bytes:
        """The text of the file with the change."""
        return text[: self.start] + self.new.encode() + text[self.end :]


def sample(root: Path, rooms: tuple[str, ...], count: int, seed: int) -> list[Mutant]:
    """Random mutants of all files of some folders of ``src/stepbot``, the same for the same seed and source."""
    files = sorted(file for room in rooms for file in (root / "src/stepbot" / room).rglob("*.py"))
    every = [mutant for file in files for mutant in mutants_of(file, root)]
    return random.Random(seed).sample(every, min(count, len(every)))


def mutants_of(file: Path, root: Path) -> Iterator[Mutant]:
    """All mutants of a file, in the order of its text."""
    text = file.read_bytes()
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tree = ast.parse(text)
    for node, function in _code(tree):
        for place, new in _changes(node):
            start = starts[place.lineno - 1] + place.col_offset
            end = starts[(place.end_lineno or place.lineno) - 1] + (place.end_col_offset or 0)
            old = text[start:end].decode()
            new = f"({new})" if isinstance(node, ast.expr) else new
            if _dump(old, node) != _dump(new, node):
                name, first = (function.name, function.lineno) if function is not None else ("", 0)
                yield Mutant(file.relative_to(root).as_posix(), place.lineno, name, first, start, end, old, new)


def _dump(text: str, node: ast.AST) -> str:
    return ast.dump(ast.parse(f"({text})")) if isinstance(node, ast.expr) else text


Function = ast.FunctionDef | ast.AsyncFunctionDef


def _code(tree: ast.Module) -> Iterator[tuple[ast.AST, Function | None]]:
    """Nodes that run, each with its innermost function: no annotations, imports and raised messages."""
    pending: list[tuple[ast.AST, Function | None]] = [(tree, None)]
    while pending:
        node, function = pending.pop(0)
        yield node, function
        inner = node if isinstance(node, Function) else function
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "format_spec", "type_params"):
                continue
            for child in value if isinstance(value, list) else [value]:
                is_code = isinstance(child, ast.AST) and not isinstance(child, ast.Raise | ast.Import | ast.ImportFrom)
                if is_code and not isinstance(child, ast.JoinedStr | ast.Assert) and not _is_for_types(child):
                    pending.append((child, inner))


def _is_for_types(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def _changes(node: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """What can replace a node: the place, and the new text."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        for other in _SWAPPED.get(type(node.ops[0]), ()):
            yield node, ast.unparse(ast.Compare(node.left, [other()], node.comparators))  # type: ignore[list-item]
    elif isinstance(node, ast.BinOp):
        for other in _SWAPPED.get(type(node.op), ()):
            yield node, ast.unparse(ast.BinOp(node.left, other(), node.right))  # type: ignore[arg-type]
    elif isinstance(node, ast.BoolOp):
        for other in _SWAPPED[type(node.op)]:
            yield node, ast.unparse(ast.BoolOp(other(), node.values))  # type: ignore[arg-type]
        for left_out in range(len(node.values)):
            rest = [value for number, value in enumerate(node.values) if number != left_out]
            yield node, ast.unparse(rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield node, ast.unparse(node.operand)
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield node, repr(not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int):
        yield node, repr(node.value + 1)
    elif isinstance(node, ast.Constant) and isinstance(node.value, float):
        for factor in _FACTORS:
            yield node, repr(node.value * factor if node.value else 1.0)
    elif isinstance(node, ast.IfExp):
        yield node, ast.unparse(node.body)
        yield node, ast.unparse(node.orelse)
    elif isinstance(node, ast.Continue | ast.Break | ast.AugAssign):
        yield node, "pass"
    elif isinstance(node, ast.Expr):
        yield from [(node, "pass")] if isinstance(node.value, ast.Call) else []
