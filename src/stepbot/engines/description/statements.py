"""Everything that a description states, place by place: for what no engine reports, the text itself is compared.

What a mesh file contains is stated at the element that names the file: the area of its surface, the centroid of that,
and its radius of gyration about the centroid. Engines report no more of a mesh than its box.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from stepbot.geometry.mesh import surface_moments
from stepbot.geometry.mesh_files import read_content
from stepbot.runtime.file import is_file, read_regular

from ..resources import resolve
from ..xml import xml_root
from .mjcf_vocabulary import MJCF
from .sdf_vocabulary import AROUND, MODEL
from .urdf_vocabulary import URDF
from .vocabulary import Vocabulary

_VOCABULARIES = {"urdf": URDF, "sdf": AROUND, "mjcf": MJCF}
_KEYS = ("name", "reference", "filename", "joint", "site")
"""Attributes that identify one of several elements of a tag."""
_PAIRS = ("joint1", "joint2", "body1", "body2", "site1", "site2", "geom1", "geom2")
"""Attributes of MJCF that together identify an element without any of these; only then does a class."""
_LONGEST_PLACE = 1000


class Statement(Struct, frozen=True):
    """One attribute, or the text of one element."""

    place: str
    """Tags down from the root, with names or numbers of elements."""
    value: str
    read: bool
    """Whether it reaches the model, so that engines can be expected to report it."""


def statements(
    file: Path, written_in: str, packages: Iterable[Path] = (), *, surfaces: bool = False
) -> tuple[Statement, ...]:
    """The statements of a file and, in their places, of those that an MJCF includes; none of a format that is not XML.

    Args:
        packages: Folders of packages, or those that contain them, in which meshes are searched, too.
        surfaces: Whether to add area, centroid and radius of gyration of the surface of each mesh file.

    Raises:
        EngineRefused: The file is not XML.
    """
    vocabulary = _VOCABULARIES.get(written_in)
    if vocabulary is None:
        return ()
    top = _whole(file)
    return tuple(_below(top, vocabulary, _MeshFiles(top, file, packages).surface if surfaces else _no_surface))


def _whole(file: Path) -> Any:
    """The root of a file, with what an MJCF includes in place of each include, as MuJoCo reads it: each file once."""
    top, known = xml_root(file), {file}
    if top.tag != "mujoco":
        return top
    while (include := next(top.iter("include"), None)) is not None:
        path, holder = file.parent / include.get("file", ""), include.getparent()
        place = holder.index(include)
        holder[place : place + 1] = list(xml_root(path)) if path not in known and is_file(path) else []
        known.add(path)
    return top


def mesh_hash(file: Path, packages: Iterable[Path]) -> str:
    """A hash of the mesh files that a description names, in its order: files of equal hashes have equal surfaces.

    Raises:
        EngineRefused: The file is not XML.
    """
    top, whole = _whole(file), sha256()
    files = _MeshFiles(top, file, packages)
    for path in filter(None, map(files.path, top.iter("mesh"))):
        content = str(path).encode()
        if path.suffix.lower() != ".gltf":  # whose triangles are in other files
            with suppress(OSError):  # a file that cannot be read has no surface
                content = path.suffix.encode() + read_regular(path)
        whole.update(sha256(content).digest())
    return whole.hexdigest()


class _MeshFiles:
    """The mesh files that a description names; each is read once."""

    def __init__(self, top: Any, file: Path, packages: Iterable[Path]) -> None:
        self._file, self._packages, self._known = file, tuple(packages), dict[Path, Mapping[str, str]]()
        folders = [one.get("meshdir") or one.get("assetdir") or "" for one in top.iterfind("compiler")]
        self._folder = next((folder for folder in reversed(folders) if folder), "")

    def path(self, element: Any) -> Path | None:
        """The file of an element; None if the element names none, or the file does not exist."""
        in_folder = element.get("file", "")
        uri = element.get("filename") or (element.findtext("uri") or "").strip() or in_folder
        return resolve(str(Path(self._folder, uri)) if in_folder else uri, self._file, self._packages) if uri else None

    def surface(self, element: Any) -> Mapping[str, str]:
        """Numbers by name; empty for another element than that of a mesh, and where there are no triangles to read."""
        path = self.path(element) if element.tag == "mesh" else None
        if path is None:
            return {}
        if path not in self._known:
            self._known[path] = _surface(path)
        return self._known[path]


def _no_surface(_element: Any) -> Mapping[str, str]:
    return {}


def _surface(path: Path) -> Mapping[str, str]:
    content = read_content(path)
    if content is None:
        return {}
    area, centroid, second = surface_moments(content.mesh.vertices, content.mesh.faces)
    if not area:
        return {}
    gyration = float(np.trace(second) / area) ** 0.5
    values = {"area": [area], "centroid": centroid.tolist(), "gyration_radius": [gyration]}
    return {name: " ".join(map(repr, numbers)) for name, numbers in values.items()}


def _short(place: str) -> str:
    """A place of bounded length: of elements nested by thousands, each place would name all those above it."""
    if len(place) <= _LONGEST_PLACE:
        return place
    head, tail = place[: -_LONGEST_PLACE // 2], place[-_LONGEST_PLACE // 2 :]
    return f"({sha256(head.encode()).hexdigest()[:12]}){tail}"


def _below(top: Any, vocabulary: Vocabulary, surface: Callable[[Any], Mapping[str, str]]) -> Iterator[Statement]:
    """The statements in the order of the file, without recursion: elements may be nested by thousands."""
    waiting = [(top, str(top.tag), str(top.tag), vocabulary, True)]
    while waiting:
        element, path, place, vocabulary, read = waiting.pop()
        for name, value in element.attrib.items():
            known = read and vocabulary.reads(path, name, str(element.tag))
            each = _by_actuator(top, value) if (element.tag, name) == ("key", "ctrl") else {"": value}
            yield from (Statement(f"{place}@{name}{key}", one, known) for key, one in each.items())
        if text := (element.text or "").strip():
            yield Statement(place, text, read)
        for name, value in surface(element).items():
            yield Statement(f"{place}@{name}", value, read)
        children, numbers = [], Counter[str]()
        for child in (child for child in element if isinstance(child.tag, str)):
            words, below = vocabulary, vocabulary.below(path, child)
            if vocabulary is AROUND and child.tag == "model":
                words, below = MODEL, "model"
            tag = f"{child.tag} {_key(child)}".strip()
            numbers[tag] += 1
            numbered = tag if numbers[tag] == 1 else f"{tag} {numbers[tag]}"
            children.append((child, below, _short(f"{place}/{numbered}"), words, read and below in words.read))
        waiting += reversed(children)


def _key(element: Any) -> str:
    """What identifies an element among those of its tag, whatever their order; empty if nothing does."""
    keys = [element.get(name) for name in _KEYS if element.get(name)][:1]
    keys = keys or [element.get(name) for name in _PAIRS if element.get(name)]
    keys += [text] if element.tag == "plugin" and (text := (element.findtext("joint_name") or "").strip()) else []
    return " ".join(f"'{key}'" for key in keys or [element.get("class")] if key)


def _by_actuator(top: Any, values: str) -> Mapping[str, str]:
    """The controls of a keyframe by the names of the actuators, whose order means nothing; else as they are."""
    names, numbers = [one.get("name") for one in top.iterfind("actuator/*")], values.split()
    if not all(names) or len({*names}) != len(numbers) or len(names) != len(numbers):
        return {"": values}
    return {f" of '{name}'": number for name, number in zip(names, numbers, strict=True)}
