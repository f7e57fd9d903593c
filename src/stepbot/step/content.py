"""Reads the files of an assembly one after the other, and combines them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from stepbot.diagnostics import Diagnostics, Span

from .exchange.file_set import StepFile
from .exchange.length_unit import LengthUnit
from .one_file import FileContent, guarded, optional, read_file
from .structure.composition import Composition, FileDefinitions
from .structure.source import Definition
from .structure.tree import Tree, grow
from .validation.comparison import Stated
from .validation.properties import read_statements
from .validation.subjects import Subjects


@dataclass(frozen=True, eq=False)
class Content:
    """An assembly before its bodies are made."""

    unit: LengthUnit
    definitions: list[Definition]
    tree: Tree
    stated: list[Stated]
    """Values stated in the files for comparison."""
    mechanisms: int
    """Number of kinematic mechanisms in the file of the assembly."""
    external: tuple[str, ...]
    """Names of the other files that were read."""


def read_content(files: tuple[StepFile, ...], found: Diagnostics) -> Content | None:
    """Everything but the bodies; None, with the reason in ``found``, after an error.

    Args:
        files: The file of the assembly first; others are read if a product needs them.
        found: Receives the diagnostics of the files.
    """
    contents = _read_all(files, found)
    if contents is None or _has_cycle(contents, files, found):
        return None
    return guarded(files[0].place, found, lambda: _put_together(contents, files, found))


def _put_together(
    contents: Mapping[int, FileContent], files: tuple[StepFile, ...], found: Diagnostics
) -> Content | None:
    numbers = {file: number for number, file in enumerate(contents)}
    composition = Composition(
        [
            FileDefinitions(
                content.definitions.all,
                content.definitions.roots,
                content.materials,
                {own: numbers[file] for own, file in content.elsewhere.items()},
            )
            for content in contents.values()
        ]
    )
    place, definitions = files[0].place, composition.definitions
    tree = grow(definitions, composition.roots, composition.materials, place, found)
    if tree is None:
        return None
    is_complete = not any(definition.missing for definition in definitions)
    if not tree.variants and is_complete:
        found.add("SB205", "the kernel could build no geometry", Span(place), help=["export it as a B-rep"])
        return None

    def read_stated() -> list[Stated]:
        read = zip(contents.values(), composition.places(), strict=True)
        return [value for content, places in read for value in _stated(content, places, definitions, tree)]

    # Of an incomplete assembly, what the file states is of other parts, too.
    stated: list[Stated] = []
    if is_complete:
        stated = optional("validation properties", place, found, read_stated, stated)
    external = tuple(files[file].name for file in contents if file)
    return Content(_unit(contents), definitions, tree, stated, contents[0].mechanisms, external)


def _read_all(files: tuple[StepFile, ...], found: Diagnostics) -> dict[int, FileContent] | None:
    """Indices of the needed files, ascending."""
    contents: dict[int, FileContent] = {}
    pending = [0]
    while pending:
        file = pending.pop(0)
        if file in contents:
            continue
        content = read_file(files[file], found)
        if content is None:
            return None
        contents[file] = content
        pending += content.elsewhere.values()
    return dict(sorted(contents.items()))


def _has_cycle(contents: Mapping[int, FileContent], files: tuple[StepFile, ...], found: Diagnostics) -> bool:
    """Whether a file needs itself, directly or indirectly; such a cycle is reported in ``found``."""
    done: set[int] = set()
    path: list[int] = []
    pending: list[tuple[int, bool]] = [(0, False)]
    while pending:
        file, is_left = pending.pop()
        if is_left:
            done.add(path.pop())
        elif file in path:
            names = [files[one].name for one in [*path[path.index(file) :], file]]
            found.add(
                "SB203",
                f"circular external reference: {' -> '.join(names)}",
                Span(files[path[-1]].place),
                help=["export the assembly as one STEP file, with external references switched off"],
            )
            return True
        elif file not in done:
            path.append(file)
            pending.append((file, True))
            pending += [(other, False) for other in dict.fromkeys(contents[file].elsewhere.values())]
    return False


def _stated(content: FileContent, places: Mapping[int, int], definitions: list[Definition], tree: Tree) -> list[Stated]:
    statements = read_statements(content.session)
    if not statements:
        return []
    subjects = Subjects(content.session, content.products, places, definitions, tree)
    return [Stated(subjects.of(s.subject), s.quantity, s.value) for s in statements]


def _unit(contents: Mapping[int, FileContent]) -> LengthUnit:
    """The unit of the assembly's own file, and the further ones of all files."""
    unit = contents[0].unit
    names = [name for content in contents.values() for name in (content.unit.name, *content.unit.others)]
    return replace(unit, others=tuple(dict.fromkeys(name for name in names if name != unit.name)))
