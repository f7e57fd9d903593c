"""A copy of a description in which meshes have absolute paths; to be called in a worker process."""

from collections.abc import Iterable
from pathlib import Path

from .resources import resolve


def located_copy(file: str, copy: str, packages: Iterable[Path]) -> None:
    """Write a copy for engines that do not search folders of packages; meshes that are not found keep their names.

    Args:
        file: The description.
        copy: Path of the copy.
        packages: Folders of packages.
    """
    from lxml import etree

    top = etree.parse(file, etree.XMLParser(resolve_entities=False, no_network=True)).getroot()
    for element in top.iter("mesh", "uri"):
        uri = element.get("filename", "") or (element.text or "").strip()
        found = resolve(uri, Path(file), packages) if uri else None
        if found is not None and element.get("filename"):
            element.set("filename", found.resolve().as_posix())
        elif found is not None:
            element.text = found.resolve().as_posix()
    Path(copy).write_bytes(etree.tostring(top, encoding="UTF-8", xml_declaration=True))
