"""Resolves the mesh files of a description: relative paths, ``file://``, ``package://`` and ``model://``."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from urllib.parse import unquote, urlsplit

from stepbot.runtime.file import is_file

_SCHEMES = ("package", "model", "file")


def resolve(uri: str, description: Path, packages: Iterable[Path] = ()) -> Path | None:
    """The file that ``uri`` refers to in a description; None if it does not exist.

    A package is searched upwards from the description: ``package://arm/meshes/a.obj`` is ``meshes/a.obj`` in the first
    folder above that contains it, or in its subfolder ``arm``; before that in ``packages``, folders of packages or the
    folders that contain them.
    """
    return next((candidate for candidate in candidates(uri, description, packages) if is_file(candidate)), None)


def candidates(uri: str, description: Path, packages: Iterable[Path] = ()) -> Iterator[Path]:
    """Candidate paths of the file that ``uri`` refers to, the likeliest first."""
    scheme, _, rest = uri.partition("://")
    if not rest or scheme not in _SCHEMES:
        yield description.parent / uri
    elif scheme == "file":
        yield Path(unquote(urlsplit(uri).path))
    else:
        inside = Path(*Path(rest).parts[1:])
        for folder in (*packages, *description.absolute().parents):
            yield from (folder / rest, folder / inside)
