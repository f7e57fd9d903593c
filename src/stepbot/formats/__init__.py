"""Writes a robot in each format; for ``verification`` and above. One package per format, discovered in this folder.

A package in this one with a module ``writer`` is a format. Its ``__init__`` has ``FORMAT``, the declaration
(:class:`.format.Format`), and imports nothing slow. The writer has ``EXPRESSES`` (how the format expresses each
feature, see :mod:`.features`), ``reserves``, ``render``, which turns a robot that :func:`.lowering.lower` has prepared
into the bytes of its main file, and ``companions``, files for readers that need more than the main file. Nothing else
lists the formats, and nothing here accesses the disk.
"""

import os
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import cast

from .format import Format

__all__ = ["FORMATS", "Format", "default_formats", "format_named"]


def _discover() -> dict[str, Format]:
    folders = sorted(one.name for path in __path__ for one in os.scandir(path) if Path(one, "writer.py").is_file())
    declared = [cast(Format, import_module(f"{__name__}.{name}").FORMAT) for name in folders]
    return {one.name: one for one in sorted(declared, key=lambda one: one.order)}


FORMATS: Mapping[str, Format] = _discover()
"""All formats by name, in their order."""


def default_formats() -> tuple[str, ...]:
    """Names of the formats that are written when none is selected."""
    return tuple(name for name, one in FORMATS.items() if one.default)


def format_named(name: str) -> Format:
    """The format with a name or an alias.

    Raises:
        KeyError: There is no such format.
    """
    for one in FORMATS.values():
        if name.lower() in (one.name, *one.aliases):
            return one
    raise KeyError(name)
