"""Evaluates the expressions of macros: arithmetic, texts, lists and dictionaries, and functions that cannot do harm.

xacro looks for names with two underscores in an expression, but not within the comprehensions in it, nor for those
that lead from a generator to the interpreter. Here each attribute is looked up by a function that lists what it may
return, and syntax that is not listed is rejected.
"""

import ast
from pathlib import Path
from typing import Any, NamedTuple

from stepbot.diagnostics import Span


class Expansion(NamedTuple):
    """What a xacro expands to, or why it does not."""

    text: bytes
    """The URDF, one element a line, meshes with absolute paths; empty after an error."""
    places: tuple[Span, ...]
    """For each line of the URDF, where its element is stated; the first line has number 1, and is at index 1."""
    files: tuple[Path, ...]
    """The other files that were read."""
    arguments: tuple[str, ...]
    """Names of the arguments that the xacro declares or uses."""
    error: str = ""
    at: Span = Span("")
    calls: tuple[Span, ...] = ()
    """The macro calls around the error, the innermost first."""


_NAMESPACE = "NameSpace"
_ATTRIBUTE = "__attribute__"
_PLAIN = (dict, list, tuple, str, int, float, bool, set, frozenset, complex)
"""Types whose methods reach nothing but their own content."""
_REACHING = ("format", "format_map")
"""Methods of texts that look up attributes of anything."""
REMOVED = ("type", "vars")
"""Functions of xacro's namespace ``python`` that lead from any value to all classes."""
_SYNTAX: tuple[type[ast.AST], ...] = (
    *(ast.Expression, ast.Constant, ast.Name, ast.Load, ast.Store, ast.Attribute, ast.Subscript, ast.Slice),
    *(ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.Call, ast.keyword, ast.Starred),
    *(ast.List, ast.Tuple, ast.Dict, ast.Set, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp),
    *(ast.comprehension, ast.Lambda, ast.arguments, ast.arg, ast.JoinedStr, ast.FormattedValue),
    *(ast.operator, ast.unaryop, ast.boolop, ast.cmpop),
)


class Forbidden(Exception):
    """An expression asks for more than a description needs."""


class _Guarded(ast.NodeTransformer):
    """The expression with a call in place of each attribute."""

    def visit(self, node: ast.AST) -> Any:
        if not isinstance(node, _SYNTAX):
            raise Forbidden(f"{type(node).__name__} is not allowed in an expression")
        if isinstance(node, ast.Name) and node.id.startswith("__"):
            raise Forbidden(f"the name '{node.id}' is not allowed")
        node = self.generic_visit(node)
        if isinstance(node, ast.Attribute):
            return ast.Call(ast.Name(_ATTRIBUTE, ast.Load()), [node.value, ast.Constant(node.attr)], [])
        return node


def evaluate(expression: str, symbols: dict[str, Any], local: dict[str, Any] | None = None) -> Any:
    """The value of an expression, in place of ``xacro.safe_eval``.

    Raises:
        Forbidden: It asks for more than a description needs.
        SyntaxError: It is not Python.
        Exception: What the expression raises.
    """
    tree = _Guarded().visit(ast.parse(expression.strip(), mode="eval"))
    code = compile(ast.fix_missing_locations(tree), "<expression>", "eval")
    symbols.update(__builtins__={_ATTRIBUTE: _attribute})
    return eval(code, symbols, local)  # bounded by the syntax above, and by _attribute


def _attribute(value: Any, name: str) -> Any:
    """An attribute that reaches nothing but the value itself, or an entry of a namespace or of YAML."""
    if name.startswith("_") or (isinstance(value, str) and name in _REACHING):
        raise Forbidden(f"the attribute '{name}' is not allowed")
    if type(value).__name__ == _NAMESPACE and isinstance(value, dict):
        return _entry(value, name)
    if isinstance(value, dict) and not hasattr(dict, name):
        return _entry(value, name)
    if isinstance(value, _PLAIN):
        return getattr(value, name)
    raise Forbidden(f"attributes of a {type(value).__name__} are not allowed")


def _entry(value: dict[str, Any], name: str) -> Any:
    try:
        return value[name]
    except KeyError:
        raise AttributeError(f"there is no '{name}'") from None
