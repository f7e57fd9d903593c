"""The page in one file: HTML, style, scripts, and the scene as data.

The scripts are ES modules; here each becomes a function that returns its exports, in the order of their imports, so
that the page needs no second file. The Content-Security-Policy allows the page's own script and style, by their hashes,
and nothing else; names from files are data, in which no markup is left.
"""

import re
from base64 import b64encode
from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from html import escape
from importlib.resources import files
from typing import Any

from .scene import scene_text

_IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([\w]+)\.js";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?:async )?(?:const|let|function|class) (\w+)", re.MULTILINE)
_ESCAPES = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"})

MAIN = "main"
"""Module that starts the page."""
STYLE = "style.css"


def page_html(
    title: str,
    scene: dict[str, Any] | None,
    *,
    modules: tuple[str, ...] = (MAIN,),
    connect: str = "",
    styles: Iterable[str] = (STYLE,),
    after: str = "",
) -> str:
    """The page.

    Args:
        scene: The robot that it shows; None for a page whose server sends one.
        modules: Scripts to start; what they import comes with them.
        connect: Sources that the page may connect to, as in a Content-Security-Policy; empty for none.
        styles: Style sheets, one after the other.
        after: HTML that follows the robot.
    """
    style, script = "".join(_resource(name) for name in styles), bundle(modules)
    parts = {
        "policy": escape(policy(style, script, connect)),
        "title": escape(title),
        "style": style,
        # JSON that stays data within a script element, whatever names it holds.
        "scene": "" if scene is None else scene_text(scene).translate(_ESCAPES),
        "script": script,
        "after": after,
    }
    return re.sub(r"@(\w+)@", lambda match: parts[match[1]], _resource("page.html"))


def plain_page(title: str, body: str) -> str:
    """A page without scripts: a title and a body of HTML, in the same style."""
    style = _resource(STYLE) + _resource("report.css")
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{escape(policy(style))}">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n"
    )


def policy(style: str, script: str = "", connect: str = "") -> str:
    """A Content-Security-Policy that allows this style and this script and nothing else."""
    rules = ["default-src 'none'", *([f"script-src {_hash(script)}"] if script else []), f"style-src {_hash(style)}"]
    rules += [f"connect-src {connect}"] if connect else []
    return "; ".join([*rules, "base-uri 'none'", "form-action 'none'"])


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


@cache
def bundle(names: tuple[str, ...]) -> str:
    """Modules and everything that they import, as one script.

    Raises:
        ValueError: Modules import each other in a circle.
    """
    order: dict[str, str] = {}
    for name in names:
        _collect(name, order, ())
    return "".join(order.values())


def _collect(name: str, order: dict[str, str], above: tuple[str, ...]) -> None:
    if name in above:
        raise ValueError(f"modules import each other: {' -> '.join((*above, name))}")
    if name in order:
        return
    text = _resource(f"{name}.js")
    for _, imported in _IMPORT.findall(text):
        _collect(imported, order, (*above, name))
    body = _IMPORT.sub(lambda match: f"const {{{match[1].replace(' as ', ': ')}}} = {_variable(match[2])};\n", text)
    exports = ", ".join(_EXPORT.findall(text))
    body = re.sub(r"^export ", "", body, flags=re.MULTILINE)
    order[name] = f"const {_variable(name)} = (() => {{\n{body}return {{ {exports} }};\n}})();\n"


def _variable(name: str) -> str:
    return f"module_{name}"


@cache
def _resource(name: str) -> str:
    return (files(__package__) / "page" / name).read_text(encoding="utf-8")
