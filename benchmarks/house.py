"""Print how large the code base is: ``python -m benchmarks.house``."""

import ast
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = (ROOT / "src", ROOT / "cli")


def figures() -> dict[str, int]:
    """Lines and files of Python, record classes, diagnostic codes, and floors of the import graph of rooms."""
    files = sorted(path for source in SOURCES for path in source.rglob("*.py"))
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in files}
    from stepbot.diagnostics.codes import CODES

    return {
        "lines of Python in src and cli": sum(len(path.read_text(encoding="utf-8").splitlines()) for path in files),
        "files": len(files),
        "record classes": sum(map(_is_record, (node for tree in trees.values() for node in ast.walk(tree)))),
        "diagnostic codes": len(CODES),
        "floors of rooms": len(floors(trees)),
    }


def _is_record(node: ast.AST) -> bool:
    """Whether a node is a struct, a named tuple, or a model of pydantic."""
    if not isinstance(node, ast.ClassDef):
        return False
    names = [ast.unparse(one) for one in (*node.decorator_list, *node.bases)]
    return any(name.startswith(("Struct", "NamedTuple", "BaseModel", "Section", "TypedDict")) for name in names)


def floors(trees: dict[Path, ast.Module]) -> list[tuple[str, ...]]:
    """The rooms, from the lowest floor up: each floor imports only lower ones; type checkers' imports count.

    Raises:
        CycleError: Rooms import each other.
    """
    graph: dict[str, set[str]] = {}
    for path, tree in trees.items():
        parts = path.relative_to(path.parents[-1] / ROOT).with_suffix("").parts[1:]
        if parts[0] != "stepbot" or parts[1] in ("__init__", "__main__"):
            continue
        graph.setdefault(parts[1], set()).update(room for room in _imported(tree) if room != parts[1])
    sorter = TopologicalSorter(graph)
    sorter.prepare()
    levels = []
    while sorter.is_active():
        ready = tuple(sorted(sorter.get_ready()))
        levels.append(ready)
        sorter.done(*ready)
    return levels


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        names = [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
        names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        for name in names:
            if name.startswith("stepbot."):
                yield name.split(".")[1]


def main() -> None:
    """Print the figures, the rooms by floor, and the lines of each room and of the folders in it."""
    for name, value in figures().items():
        print(f"{value:7,} {name}")
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for source in SOURCES for path in source.rglob("*.py")}
    for level in reversed(floors(trees)):
        print(f"        {', '.join(level)}")
    rooms = Counter[str]()
    for path in trees:
        room = "/".join(path.relative_to(ROOT).parts[2:-1][:2]) or "stepbot_cli"
        rooms[room] += len(path.read_text(encoding="utf-8").splitlines())
    for room, lines in sorted(rooms.items()):
        print(f"{lines:7,} {room}")


if __name__ == "__main__":
    try:
        main()
    except CycleError as error:
        raise SystemExit(f"rooms import each other: {error.args[1]}") from error
