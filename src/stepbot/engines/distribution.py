"""The installed distribution that a module comes from; `pybullet` comes from `pybullet` or from `pybullet-arm64`."""

from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import TypedDict

from stepbot.runtime.file import read_regular

_DEEPEST = 6
"""Folders above a module in which lists are looked for."""


class Provider(TypedDict):
    """Name and version of a distribution, as fields of an observation."""

    distribution: str
    version: str


@cache
def provider(module: str) -> Provider:
    """The distribution that an installed top-level module comes from.

    Reads the lists of installed files in the folder of the module or above, 0.05 s. `packages_distributions` of Python
    takes a second, and is asked only if no list has the module. Without any answer, as for a module that was compiled
    in place, the version is "unknown".
    """
    spec = find_spec(module)
    if spec is not None and spec.origin is not None:
        file = Path(spec.origin)
        # Some wheels have their modules in a prefix below the folder of all packages.
        for site in [*file.parents][bool(spec.submodule_search_locations) : _DEEPEST]:
            listed = _listing(site, file)
            if listed:
                return min(listed, key=lambda one: one["distribution"] != module)
    names = metadata.packages_distributions().get(module)
    if not names:
        return Provider(distribution=module, version="unknown")
    return Provider(distribution=names[0], version=metadata.version(names[0]))


def _listing(site: Path, file: Path) -> list[Provider]:
    """The distributions in a folder that list a file with its present size; one installed later may overwrite it."""
    start, end = f"\n{file.relative_to(site).as_posix()},".encode(), f",{file.stat().st_size}".encode()
    providers = []
    for record in sorted(site.glob("*.dist-info/RECORD")):
        _, listed, rest = (b"\n" + read_regular(record)).partition(start)
        if listed and rest.partition(b"\n")[0].rstrip().endswith(end):
            name, _, version = record.parent.name.removesuffix(".dist-info").partition("-")
            providers.append(Provider(distribution=name.replace("_", "-"), version=version))
    return providers
