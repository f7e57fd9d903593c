"""The reference in docs/api.md, from the signatures and docstrings of what ``import stepbot`` offers."""

import ast
import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

import stepbot
from stepbot import api

RECORDS = (
    "stepbot.pipeline.conversion:Conversion",
    "stepbot.api:CheckResult",
    "stepbot.pipeline.conversion:Checked",
    "stepbot.pipeline.stages:Inspection",
    "stepbot.step.assembly:Assembly",
    "stepbot.step.assembly:Component",
    "stepbot.api:Verification",
    "stepbot.report.robot:Report",
    "stepbot.report.results:Check",
    "stepbot.robot.joint_table:JointRow",
    "stepbot.diagnostics:Diagnostics",
    "stepbot.diagnostics:Diagnostic",
    "stepbot.diagnostics:Span",
    "stepbot.diagnostics:StepbotError",
    "stepbot.robot.model:Robot",
    "stepbot.robot.model:Link",
    "stepbot.robot.model:Joint",
    "stepbot.robot.model:LoopClosure",
)
"""The records that the functions return, and what these consist of."""
REFERENCE = "## Reference\n"
_HEAD = f"""\
{REFERENCE}
**Stable** within a minor version are the names that `import stepbot` offers, their arguments, and the fields below.
Fields and arguments may be added; modules below `stepbot.` may move, so import from `stepbot` alone, except for
`stepbot.gym`.
`report.json` and the output of `--json` follow the same rule.

Lengths are in m, angles in rad, masses in kg. `X_AB` is the pose of frame B in frame A
([conventions](architecture.md#conventions)).
"""
_SECTION = re.compile(r"^(Args|Returns|Raises|Yields):$", re.MULTILINE)


def reference_page() -> str:
    """The page: functions in the order of ``stepbot.__all__``, then records."""
    functions = [name for name in stepbot.__all__ if inspect.isfunction(getattr(api, name))]
    parts = [_HEAD, "## Functions\n", *(_function(name) for name in functions), "## Records\n"]
    for place in RECORDS:
        module, _, name = place.partition(":")
        parts.append(_record(import_module(module), name))
    return "\n".join(parts)


def _function(name: str) -> str:
    function = getattr(api, name)
    module = ast.parse(inspect.getsource(import_module(function.__module__)))
    node = next(one for one in module.body if isinstance(one, ast.FunctionDef) and one.name == name)
    required = ", ".join([*(ast.unparse(one) for one in node.args.args), *_star(node)])
    options = [_option(arg, default) for arg, default in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)]
    signature = f"stepbot.{name}({required}" + (", *, ...)" if options else ")")
    returns = f" -> {ast.unparse(node.returns).strip(chr(39) + chr(34))}" if node.returns else ""
    defaults = ["", "Keyword arguments and their defaults: " + ", ".join(f"`{one}`" for one in options) + "."]
    text = _docstring(function)
    return "\n".join(
        [f"### {name}\n", f"```python\n{signature}{returns}\n```\n", text, *(defaults if options else []), ""]
    )


def _star(node: ast.FunctionDef) -> list[str]:
    return [f"*{ast.unparse(node.args.vararg)}"] if node.args.vararg else []


def _option(arg: ast.arg, default: ast.expr | None) -> str:
    return arg.arg if default is None else f"{arg.arg}={ast.unparse(default)}"


def _docstring(subject: Any) -> str:
    """A docstring as Markdown: roles as code, sections as lists."""
    text = re.sub(r":\w+:`~?([\w.]+)`", lambda role: f"`{role[1].rpartition('.')[2]}`", inspect.getdoc(subject) or "")
    text = text.replace("``", "`")
    summary, *sections = _SECTION.split(text)
    parts = [summary.strip()]
    for title, body in zip(sections[::2], sections[1::2], strict=True):
        lines = inspect.cleandoc(body).splitlines()
        entries: list[str] = []
        for line in lines:
            if line.startswith(" ") and entries:
                entries[-1] += f" {line.strip()}"
            elif line:
                entries.append(line)
        if title in ("Args", "Raises"):
            entries = [re.sub(r"^(\w+): ", r"- `\1`: ", entry) for entry in entries]
            parts.append("\n".join([f"{title}:\n", *entries]))
        else:
            parts.append(f"{title}: {' '.join(entries)}")
    return "\n\n".join(parts)


def _record(module: ModuleType, name: str) -> str:
    """A class: its docstring, fields, and public methods."""
    record = getattr(module, name)
    body = ast.parse(inspect.getsource(import_module(record.__module__))).body
    node = next(one for one in body if isinstance(one, ast.ClassDef) and one.name == name)
    rows = [*_fields(node), *_methods(node)]
    table = (
        ["| name | |", "| --- | --- |", *(f"| `{_cell(field)}` | {_cell(text)} |" for field, text in rows)]
        if rows
        else []
    )
    return "\n".join([f"### {name}\n", _docstring(record), "", *table, ""])


def _fields(node: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for one, after in zip(node.body, [*node.body[1:], None], strict=True):
        if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name) and not one.target.id.startswith("_"):
            kind = ast.unparse(one.annotation).strip("'\"")
            documented = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            text = inspect.cleandoc(str(after.value.value)) if documented else ""  # type: ignore[union-attr]
            yield f"{one.target.id}: {kind}", text


def _methods(node: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for one in node.body:
        if isinstance(one, ast.FunctionDef) and not one.name.startswith("_"):
            is_property = any(isinstance(d, ast.Name) and "property" in d.id for d in one.decorator_list)
            arguments = ", ".join(arg.arg for arg in (*one.args.args[1:], *one.args.kwonlyargs))
            summary = (ast.get_docstring(one) or "").partition("\n\n")[0]
            yield one.name if is_property else f"{one.name}({arguments})", summary


def _cell(text: str) -> str:
    text = re.sub(r":\w+:`~?([\w.]+)`", lambda role: f"`{role[1].rpartition('.')[2]}`", " ".join(text.split()))
    return text.replace("``", "`").replace("|", "\\|")
