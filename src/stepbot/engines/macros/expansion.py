"""Expands a xacro to URDF; to be called in a worker process of its own, which it locks."""

import os
import sys
import xml.dom.minidom
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from xml.dom import expatbuilder
from xml.parsers.expat import ExpatError
from xml.sax.saxutils import escape, quoteattr

from lxml import etree

from stepbot.diagnostics import Span
from stepbot.runtime.file import is_file, is_folder, open_regular, resolved

from ..source_copy import locate
from .expressions import REMOVED, Expansion, evaluate

_PLACE = "place"
_MANIFEST = "package.xml"
_BARRED = ("subprocess.", "os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.fork", "socket.", "ctypes.", "pty.")
"""Events of the interpreter that no macro causes: nothing runs, and nothing is sent."""
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def expand(file: str, arguments: Mapping[str, str], packages: tuple[Path, ...]) -> Expansion:
    """Expand a xacro.

    Args:
        file: Absolute path.
        packages: Folders of packages, or the folders that contain them.
    """
    import xacro
    import xacro.substitution_args

    path = resolved(Path(file))
    return _Expansion(xacro, path, _Packages(path, packages)).run(dict(arguments))


class _Packages:
    """Finds packages by name, and allows reads of these packages and that of the xacro alone."""

    def __init__(self, file: Path, packages: tuple[Path, ...]) -> None:
        above = [folder for folder in file.parents if is_file(folder / _MANIFEST)]
        self._own = above[0] if above else file.parent
        self.searched = [*(resolved(folder) for folder in packages), *file.parents]
        self._readable = [self._own]

    def find(self, name: str) -> str:
        """The folder of a package, in place of the environment of ROS."""
        for folder in self.searched:
            named = folder.name == name and is_file(folder / _MANIFEST)
            for one in ((folder,) if named else ()) + (folder / name, folder / "share" / name):
                if name and Path(name).name == name and is_folder(one):
                    self._readable.append(resolved(one))
                    return resolved(one).as_posix()
        raise LookupError(f"package '{name}' not found")

    def open(self, name: str, *_: Any, **__: Any) -> Any:
        """A file of these packages, as text."""
        path = resolved(Path(name))
        if not any(path.is_relative_to(folder) for folder in self._readable):
            raise PermissionError(0, f"outside of the package '{self._own.name}', and of the packages found", name)
        if not is_file(path):
            raise FileNotFoundError(2, "no such file", name)
        return open_regular(path)


class _Expansion:
    """One expansion, with xacro's functions replaced by those that are bounded and know where they are."""

    def __init__(self, xacro: Any, file: Path, packages: _Packages) -> None:
        self._xacro, self._file, self._packages = xacro, file, packages
        self._at = Span(str(file))
        self._calls: list[Span] = []
        self._failed: tuple[Span, tuple[Span, ...]] | None = None
        self._arguments: dict[str, None] = {}

    def run(self, arguments: dict[str, str]) -> Expansion:
        self._replace()
        _bar()
        try:
            document = self._xacro.process_file(str(self._file), mappings=arguments)
        except RecursionError:
            return self._error("macros call each other without end")
        except ExpatError as error:
            file = (self._xacro.filestack or [str(self._file)])[-1]
            self._at, self._failed = Span(str(file), error.lineno), None
            return self._error(f"not XML: {str(error).partition(':')[0]}")
        except Exception as error:  # noqa: BLE001 # whatever an expression raises
            return self._error(_reason(error))
        text, places = _written(document, str(self._file))
        top = etree.fromstring(text, etree.XMLParser(resolve_entities=False, no_network=True))
        locate(top, self._file, self._packages.searched)
        return Expansion(etree.tostring(top), places, self._read(), tuple(self._arguments))

    def _error(self, text: str) -> Expansion:
        at, calls = self._failed or (self._at, tuple(reversed(self._calls)))
        return Expansion(b"", (), self._read(), tuple(self._arguments), text, at, calls)

    def _read(self) -> tuple[Path, ...]:
        return tuple(dict.fromkeys(Path(name) for name in self._xacro.all_includes))

    def _replace(self) -> None:
        xacro, args = self._xacro, self._xacro.substitution_args
        xacro.safe_eval = evaluate
        xacro.open, xacro.parse = self._packages.open, self._parse
        for name in REMOVED:
            xacro._global_symbols["python"].pop(name, None)
        args._eval_find = args._eval_dict["find"] = self._packages.find
        args._eval = self._eval_argument
        args._eval_arg = self._noting(args._eval_arg)
        os.environ.clear()
        xacro.eval_all = self._touching(xacro.eval_all)
        xacro.handle_macro_call = self._calling(xacro.handle_macro_call)
        for name in ("check_attrs", "reqd_attrs"):
            setattr(xacro, name, self._touching(getattr(xacro, name)))

    def _eval_argument(self, expression: str, context: Mapping[str, Any]) -> str:
        """The value of ``$(eval ...)``, with the arguments as names."""
        args = self._xacro.substitution_args
        values = {name: args.convert_value(value, "auto") for name, value in context["arg"].items()}
        functions = {name: one for name, one in args._eval_dict.items() if not name.startswith("__")}
        plain: dict[str, Any] = {"list": list, "dict": dict, "map": map, "str": str, "float": float, "int": int}
        return str(evaluate(expression, {**plain, **functions, "arg": values.__getitem__, **values}))

    def _noting(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function that looks an argument up; one that the file uses need not be declared in it."""

        def noting(name: str, args: Any) -> Any:
            self._arguments[name] = None
            return function(name=name, args=args)

        return noting

    def _parse(self, _given: Any, filename: str) -> Any:
        """A document whose elements know their place."""
        with self._packages.open(filename) as file:
            return _Builder(filename).parseFile(file)

    def _touching(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """A function of xacro that is at the element that it gets first."""

        def touching(node: Any, *others: Any) -> Any:
            self._at = node.getUserData(_PLACE) or self._at
            if node.tagName == "xacro:arg" and node.hasAttribute("name"):
                self._arguments[node.getAttribute("name")] = None
            return function(node, *others)

        return touching

    def _calling(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function that expands a macro, with the call on the stack."""

        def calling(node: Any, *others: Any) -> Any:
            self._at = node.getUserData(_PLACE) or self._at
            self._calls.append(self._at)
            try:
                return function(node, *others)
            except Exception:
                if self._failed is None:
                    inner = tuple(reversed(self._calls))
                    self._failed = self._at, inner[1:] if inner[0] == self._at else inner
                raise
            finally:
                self._calls.pop()

        return calling


class _Builder(expatbuilder.ExpatBuilderNS):
    """Builds a document whose elements know their place, also when they are copied; entities are rejected."""

    def __init__(self, file: str) -> None:
        super().__init__()
        self._file_name = file

    def install(self, parser: Any) -> None:
        super().install(parser)
        parser.StartDoctypeDeclHandler = self._doctype

    def _doctype(self, *_: Any) -> None:
        raise ValueError("a document type with entities is not allowed")

    def start_element_handler(self, name: str, attributes: Any) -> None:
        super().start_element_handler(name, attributes)
        self.curNode.setUserData(_PLACE, Span(self._file_name, self.getParser().CurrentLineNumber), _Copied())


class _Copied:
    """Lets the copy of an element know its place."""

    def handle(self, _operation: int, key: str, data: Any, _source: Any, copy: Any) -> None:
        """See the user data of the Document Object Model, level 3."""
        if copy is not None:
            copy.setUserData(key, data, self)


def _bar() -> None:
    """Let this process write no file, start no program and send nothing, whatever it evaluates."""

    def check(event: str, given: tuple[Any, ...]) -> None:
        if event.startswith(_BARRED):
            raise PermissionError(f"{event} is not allowed while macros are expanded")
        if event == "open" and isinstance(given[2], int) and given[2] & _WRITES:
            raise PermissionError("files cannot be written while macros are expanded")

    sys.addaudithook(check)


def _reason(error: BaseException) -> str:
    """What an exception of xacro states, without its kind and its advice for the terminal."""
    inner = getattr(error, "exc", None)
    suffix = " ".join(str(getattr(error, "suffix", None) or "").split())
    if isinstance(error, SyntaxError):
        return f"{error.msg} {suffix}".strip()
    own = " ".join(str(part) for part in error.args if part is not None)
    if isinstance(inner, BaseException):
        reason = _reason(inner)
        own = reason if own.startswith("<class") else f"{own} {reason}".strip()
    if isinstance(error, OSError):
        own = f"'{error.filename}': {error.strerror}" if error.filename else str(error.strerror or error)
    return f"{own or type(error).__name__} {suffix}".strip()


def _written(document: Any, file: str) -> tuple[bytes, tuple[Span, ...]]:
    """The text of a document with each element on a line of its own, and where each is from."""
    lines, places = [""], [Span(file)]

    def begin(node: Any) -> None:
        place = node.getUserData(_PLACE) or places[-1]
        lines.append(f"<{node.tagName}")
        places.append(place)
        lines[-1] += "".join(
            f" {name}={quoteattr(str(value))}".replace("\n", " ") for name, value in node.attributes.items()
        )
        lines[-1] += ">"

    pending: list[Any] = [document.documentElement]
    while pending:
        one = pending.pop()
        if isinstance(one, str):
            lines[-1] += one
        elif one.nodeType == xml.dom.Node.ELEMENT_NODE:
            begin(one)
            pending.append(f"</{one.tagName}>")
            pending += reversed(one.childNodes)
        elif one.nodeType in (xml.dom.Node.TEXT_NODE, xml.dom.Node.CDATA_SECTION_NODE) and one.data.strip():
            lines[-1] += escape(" ".join(one.data.split()))
    return "\n".join(lines[1:]).encode(), tuple(places)
