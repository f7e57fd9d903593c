"""What of stepbot works on this machine: Python, kernel, engines, extras, cache and limits, each with its remedy."""

import os
import platform
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from importlib import import_module, metadata
from importlib.util import find_spec

from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines import engines
from stepbot.engines.engine import Engine
from stepbot.formats import FORMATS
from stepbot.runtime.cache import Cache
from stepbot.runtime.memory import memory_size
from stepbot.runtime.worker import RemoteError, Worker, WorkerDied
from stepbot.version import __version__

OK, ABSENT, PROBLEM = "ok", "not installed", "problem"
_SECONDS = 120.0
_KERNEL = "cadquery-ocp-novtk"
_LEAST_FILES = 256
"""Open files that a batch on a few cores needs: pipes of its workers, and their meshes."""
_LEAST_MEMORY = 2 << 30
"""[bytes]; the kernel alone takes a quarter of it for an assembly of a few hundred parts."""
_LEAST_DISK = 200 << 20
_PACKAGES = {
    "libGL.so.1": "libgl1",
    "libX11.so.6": "libx11-6",
    "libexpat.so.1": "libexpat1",
    "libEGL.so.1": "libegl1",
    "libgomp.so.1": "libgomp1",
}
"""Shared libraries that wheels link to, and Debian's packages of them."""
_EXTRAS: dict[str, tuple[tuple[str, ...], str]] = {
    "render": (("embreex", "PIL", "scipy"), "pictures: `stepbot render`, `inspect --picture`"),
    "view": (("watchfiles",), "`stepbot watch`"),
    "xacro": (("xacro",), "xacro as a source of `convert`"),
    "learn": (("gymnasium", "cma"), "`stepbot.gym`"),
    "draw": (("matplotlib",), "`stepbot drive --plots`"),
    "dask": (("distributed",), "`stepbot batch --scheduler`"),
}
"""Modules of each extra that is no engine, and what it is for."""


class Item(Struct, frozen=True):
    """One thing that is there, or is not."""

    area: str
    """``python``, ``kernel``, ``engine``, ``extra``, ``cache``, ``limit``, ``browser``."""
    name: str
    state: str
    """``ok``, ``not installed`` or ``problem``."""
    detail: str = ""
    """Version, size or number; for a problem what is wrong."""
    purpose: str = ""
    """What it proves, or is for."""
    fix: str = ""
    """The command that fixes it, or installs it."""


def examine(cache: Cache) -> Iterator[Item]:
    """Everything that stepbot uses; each package is imported in a process of its own."""
    where = f"{platform.system()} {platform.machine()}"
    yield Item("python", "Python", OK, f"{platform.python_version()} on {where}", f"stepbot {__version__}")
    with ExitStack() as running:
        asked: list[tuple[Item, Callable[[], str]]] = []
        kernel = Item("kernel", "geometry kernel", OK, _version(_KERNEL), "reads STEP files", f"pip install {_KERNEL}")
        if find_spec("OCP") is None:
            yield replace(kernel, state=PROBLEM, detail="not installed")
        else:
            asked.append((kernel, _importing(running, "OCP.STEPControl")))
        for engine in sorted(engines(), key=lambda one: one.order):
            item = _engine(engine)
            is_there = item.state == OK
            asked.append((item, _importing(running, f"{engine.package}.observer") if is_there else str))
        for item, error in asked:
            yield _broken(item, text) if (text := error()) else item
    yield from _extras()
    yield from _of_machine(cache)


def imported(module: str) -> str:
    """Why a module cannot be imported, or an observer's engine; empty if it can. For a worker process."""
    try:
        loaded = import_module(module)
        if module.endswith(".observer"):
            loaded.prepare()
    except (ImportError, OSError) as error:
        return f"{type(error).__name__}: {error}"
    return ""


def _importing(running: ExitStack, module: str) -> Callable[[], str]:
    """Start to import a module; returns what waits for the result."""
    worker = running.enter_context(Worker(f"{__name__}:{imported.__name__}"))
    answer = worker.submit(module)

    def error() -> str:
        try:
            return str(answer.result(_SECONDS))
        except (RemoteError, WorkerDied) as failure:
            return str(failure).splitlines()[0]

    return error


def _engine(engine: Engine) -> Item:
    titles = [FORMATS[name].title for name in engine.formats if name in FORMATS]
    purpose = f"{'confirms the text of' if engine.own_parser else 'proves'} {', '.join(titles)}"
    install = "" if engine.own_parser else engine.install or f"pip install {engine.name}"
    name = engine.title or engine.name
    reason = engine.available()
    if reason is not None:
        return Item("engine", name, ABSENT, "" if reason.endswith("not installed") else reason, purpose, install)
    own = __version__ if engine.own_parser else _version(engine.distribution or engine.name)
    return Item("engine", name, OK, own, purpose, install)


def _extras() -> Iterator[Item]:
    for name, (modules, purpose) in _EXTRAS.items():
        missing = [module for module in modules if find_spec(module) is None]
        state, lacks = (ABSENT, f"without {', '.join(missing)}") if missing else (OK, "")
        yield Item("extra", name, state, lacks, purpose, f"pip install 'stepbot[{name}]'")


def _of_machine(cache: Cache) -> Iterator[Item]:
    usage = cache.usage()
    used = f"{usage.entries} entries, {usage.size >> 20} of {cache.limit >> 20} MiB in {cache.folder}"
    above = next(folder for folder in (cache.folder, *cache.folder.parents) if folder.exists())
    if not os.access(above, os.W_OK):
        yield Item("cache", "cache", PROBLEM, f"{cache.folder} cannot be written", "", "export STEPBOT_CACHE=DIR")
    else:
        yield Item("cache", "cache", OK, used, "results of unchanged input")
    temporary = tempfile.gettempdir()
    free = shutil.disk_usage(temporary).free
    full = free < _LEAST_DISK
    left, fix = f"{free >> 20} MiB free in {temporary}", "export TMPDIR=DIR" if full else ""
    yield Item("limit", "temporary files", PROBLEM if full else OK, left, "", fix)
    files = _open_files()
    if files is not None:
        short = files < _LEAST_FILES
        purpose, fix = ("", "ulimit -n 4096") if short else ("pipes and files of parallel work", "")
        yield Item("limit", "open files", PROBLEM if short else OK, str(files), purpose, fix)
    memory = memory_size()
    if memory is not None:
        short = memory < _LEAST_MEMORY
        fix = "give the container or machine 2 GiB or more" if short else ""
        yield Item("limit", "memory", PROBLEM if short else OK, f"{memory / 2**30:.1f} GiB", "", fix)


def _open_files() -> int | None:
    """The number of files that a process may open; None on Windows, which has no such limit."""
    try:
        import resource
    except ImportError:
        return None
    return resource.getrlimit(resource.RLIMIT_NOFILE)[0]


def _broken(item: Item, error: str) -> Item:
    """An item that is installed and cannot be imported, with the package of a missing library as the remedy."""
    library = re.search(r"(lib[\w+.-]+\.so[.\d]*)", error)
    package = _PACKAGES.get(library[1], "") if library else ""
    fix = f"apt-get install {package}" if package else item.fix
    return replace(item, state=PROBLEM, detail=error, fix=fix)


def _version(distribution: str) -> str:
    """Version of a distribution, or of the one that a module comes from; empty if unknown."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        from stepbot.engines.distribution import provider

        known = find_spec(distribution) is not None
        return provider(distribution)["version"] if known else ""
