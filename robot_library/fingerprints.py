"""Hashes of inputs: outdated results are found without drawing or converting.

Scripts count by their code: a changed comment, docstring or line break leaves the hash as it is.
"""

import ast
import hashlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

_HERE = Path(__file__).parent
_DRAWING = ("drawing.py", "description.py", "moments.py", "shapes.py", "step_file.py", "step_text.py")
_OF_MACHINES = ("legs", "limb_parts", "machine", "machine_parts")
"""Modules that only some robots use."""
_LOOK = "1"
"""How all robots are rendered: raised when a change of the renderer is to redraw every picture."""
_DRIVES = "3"
"""How all robots are driven: raised when a change of the tests or of the written files is to drive every robot."""
_DIGITS = 16
_METADATA = re.compile(rb"\nmetadata: .*\n\Z")


def drawing(folder: Path) -> str:
    """Of the inputs of a robot's STEP: its scripts, its expected.json, and shared modules."""
    scripts = sorted(path for path in folder.glob("*.py") if path.name != "view.py")
    text = "\n".join(path.read_text(encoding="utf-8") for path in scripts)
    used = [f"{name}.py" for name in _OF_MACHINES if f"from ..{name} import" in text]
    return _hash((*scripts, folder / "expected.json", *(_HERE / name for name in (*_DRAWING, *used))))


def robot(folder: Path) -> str:
    """Of the inputs of a robot's conversion: its STEP and its sidecar."""
    return _hash((*sorted(folder.glob("*.step")), *sorted(folder.glob("*.robot.yaml"))))


def drives(folder: Path) -> str:
    """Of the inputs of a robot's drive tests: its conversion and its limits."""
    robot = (*sorted(folder.glob("*.step")), *sorted(folder.glob("*.robot.yaml")))
    return _hash((*robot, folder / "expected.json"), _DRIVES)


def picture(folder: Path) -> str:
    """Of the inputs of a picture: the robot, the view, and the look of all pictures."""
    robot = (*sorted(folder.glob("*.step")), *sorted(folder.glob("*.robot.yaml")))
    return _hash((*robot, folder / "view.py"), _LOOK)


def _hash(paths: Iterable[Path], salt: str = "") -> str:
    digest = hashlib.sha256(salt.encode())
    for path in paths:
        content = _content(path) if path.is_file() else b""
        digest.update(f"{path.name} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()[:_DIGITS]


def _content(path: Path) -> bytes:
    """What counts of a file: the code of a script; all of another file, with line feeds for line ends.

    The metadata of a sidecar, its last line, is for packages: it is in no table, picture or drive test.
    """
    content = path.read_bytes().replace(b"\r\n", b"\n")
    content = _METADATA.sub(b"", content) if path.name.endswith(".robot.yaml") else content
    return " ".join(_code(ast.parse(content))).encode() if path.suffix == ".py" else content


def _code(value: object) -> Iterator[str]:
    """The syntax tree without docstrings and other statements that are a string.

    Fields that are empty are left out: a later Python adds fields (``type_params`` in 3.12), and ``ast.dump`` prints
    empty ones only in some versions (before 3.13).
    """
    if isinstance(value, ast.AST):
        yield f"({type(value).__name__}"
        for name, field in ast.iter_fields(value):
            if field is not None and field != []:
                yield name
                yield from _code(field)
        yield ")"
    elif isinstance(value, list):
        yield "["
        for item in value:
            if not _is_string(item):
                yield from _code(item)
        yield "]"
    else:
        yield repr(value)


def _is_string(node: object) -> bool:
    """Whether a node is a statement that is only a string: a docstring, of a module, function, class or attribute."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
