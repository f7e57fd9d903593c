"""The robots that come with stepbot: their drawings, sidecars and pages, and the content of the pages.

A wheel has them inside the package; a checkout has them in ``robot_library/``, with the scripts that draw them.
"""

import re
from pathlib import Path

from msgspec import Struct

from stepbot.runtime.file import exists

_PACKAGE = Path(__file__).resolve().parents[1]
_PLACES = (_PACKAGE / "robots", _PACKAGE.parents[1] / "robot_library")
"""In an installed package; in a checkout."""
LIBRARY = "library:"
"""Beginning of a module's file that is a robot of the library."""
SCHEMA = "robot-1.schema.json"
"""Name of the file with the JSON Schema of sidecars."""
_SCHEMA_LINE = "# yaml-language-server: $schema="
_SIDECAR = ".robot.yaml"
_COMPOSED = "composed"
"""Folder of all composed robots, with one page."""
_NAMED = re.compile(r"\b(?:step|file): ([\w./-]+)")
"""A file that a sidecar of the library names; `library:` names come in quotation marks."""
_FACTS = re.compile(r"^(\d+ links?, .*\bkg)$", re.MULTILINE)
_PICTURE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
_LINK = re.compile(r"\[([^\]]+)\]\([^)]*\)")


def export_hint(path: str) -> tuple[str, ...]:
    """How to get the files of ``library:NAME``, which modules take and commands do not; empty for other paths."""
    if not path.startswith(LIBRARY):
        return ()
    return (f"`stepbot library export {path.removeprefix(LIBRARY)}` converts it; `stepbot library` lists the robots",)


class LibraryRobot(Struct, frozen=True):
    """A robot of the library."""

    folder: Path
    """``<maker>_<robot>``, with all its files, or ``composed``."""
    sidecar: Path

    @property
    def name(self) -> str:
        """Its name among all robots, ``<maker>_<robot>``; of a composed robot that of its files."""
        return self.short_name if self.is_composed else self.folder.name

    @property
    def is_composed(self) -> bool:
        """Whether it is composed of others, without a drawing of its own."""
        return self.folder.name == _COMPOSED

    @property
    def short_name(self) -> str:
        """Its name without the maker's, used for its files."""
        return self.sidecar.name.removesuffix(_SIDECAR)

    @property
    def step(self) -> Path:
        """Its drawing; a composed robot has none."""
        return self.folder / f"{self.short_name}.step"

    @property
    def picture(self) -> Path:
        """Its picture; a part of a composed robot has none."""
        return self.folder / (f"{self.short_name}.png" if self.is_composed else "preview.png")

    @property
    def page(self) -> Path:
        """Its page: sources of its numbers, licence, joints, links, verification; Markdown."""
        return self.folder / "README.md"

    def source(self) -> dict[str, bytes]:
        """Its sidecar, the files that it names and the sidecar's schema, by their names in a common folder."""
        files: dict[str, bytes] = {}
        waiting = [self.sidecar]
        while waiting:
            path = waiting.pop()
            content = path.read_bytes()
            if path.name.endswith(_SIDECAR):
                lines = content.decode().splitlines(keepends=True)
                text = "".join(f"{_SCHEMA_LINE}{SCHEMA}\n" if line.startswith(_SCHEMA_LINE) else line for line in lines)
                waiting += [path.parent / name for name in _NAMED.findall(text)]
                content = _NAMED.sub(
                    lambda robot: robot[0].replace(robot[1], robot[1].rpartition("/")[2]), text
                ).encode()
            files[path.name] = content
        return {
            **dict(sorted(files.items(), key=lambda file: file[0].endswith(_SIDECAR))),
            SCHEMA: schema_file().read_bytes(),
        }

    def overview(self) -> str:
        """The first paragraph of its page, on one line."""
        paragraphs = self._text().split("\n\n")[1:]
        first = next(text for text in paragraphs if text and not _PICTURE.match(text) and text[0] not in "#<|-`")
        return _LINK.sub(r"\1", " ".join(first.split()))

    def summary(self) -> str:
        """The first sentence of its page."""
        return re.split(r"(?<=\.)\s", self.overview(), maxsplit=1)[0]

    def facts(self) -> str:
        """Links, degrees of freedom, loops and mass, in a few words; empty if its page does not have them yet."""
        match = _FACTS.search(self._text())
        return match[1] if match else ""

    def table(self, title: str) -> list[list[str]]:
        """Rows of the table in a section of its page, the column titles first."""
        _, _, below = self._text().partition(f"\n## {title}\n\n")
        lines = [line for line in below.partition("\n## ")[0].splitlines() if line.startswith("|")]
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if "---" not in line]

    def _text(self) -> str:
        """Its page, or its section of the page of composed robots."""
        page = self.page.read_text(encoding="utf-8")
        if not self.is_composed:
            return page
        _, _, section = page.partition(f"\n## {self.name}\n")
        return f"# {self.name}\n" + section.partition("\n## ")[0]


def schema_file() -> Path:
    """The JSON Schema of sidecars, as a file: in an installed package, or in a checkout."""
    return next(path for place in _PLACES if exists(path := place.parent / "schemas" / SCHEMA))


def library_robots() -> tuple[LibraryRobot, ...]:
    """All robots of the library, by name; none if the installation does not include them."""
    for place in _PLACES:
        sidecars = sorted(place.glob(f"*/*{_SIDECAR}"))
        if sidecars:
            return tuple(LibraryRobot(path.parent, path) for path in sidecars)
    return ()


def library_robot(name: str) -> LibraryRobot:
    """The robot with this name, with or without its maker's.

    Raises:
        KeyError: There is none, or several have this name without their makers'.
    """
    robots = library_robots()
    matching = [robot for robot in robots if robot.name == name] or [r for r in robots if r.short_name == name]
    if len(matching) != 1:
        raise KeyError(name)
    return matching[0]


def library_sidecar(file: str) -> Path | None:
    """The sidecar of ``library:ur5e``; None if there is no such robot."""
    try:
        return library_robot(file.removeprefix(LIBRARY)).sidecar
    except KeyError:
        return None
