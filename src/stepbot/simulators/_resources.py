"""Where the mesh files are that a description names: relative paths, ``file://``, ``package://`` and ``model://``."""

from pathlib import Path
from urllib.parse import unquote, urlsplit

_SCHEMES = ("package", "model", "file")


def resolve(uri: str, description: Path) -> Path | None:
    """The file that ``uri`` means in a description; None where there is none.

    A package is looked for upwards from the description: ``package://arm/meshes/a.obj`` is ``meshes/a.obj`` in the
    first folder above that holds it, or in its subfolder ``arm``.
    """
    scheme, _, rest = uri.partition("://")
    if not rest or scheme not in _SCHEMES:
        candidate = description.parent / uri
        return candidate if candidate.is_file() else None
    if scheme == "file":
        candidate = Path(unquote(urlsplit(uri).path))
        return candidate if candidate.is_file() else None
    inside = Path(*Path(rest).parts[1:])
    for folder in description.resolve().parents:
        for candidate in (folder / rest, folder / inside):
            if candidate.is_file():
                return candidate
    return None
