"""Starts processes before the rest of stepbot is loaded: the kernel if a STEP is to be read, else engines.

Importing the kernel takes as long as all other imports together, and it runs in its own process, so it starts first. If
no kernel is needed, the common packages of the engines are imported in parallel with this process's imports. The
sidecar is only searched for the name of its STEP: a wrong guess costs an unused process, never a wrong result.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.runtime.cache import Cache, Digest, environment
from stepbot.runtime.file import is_file, open_regular
from stepbot.runtime.worker import Worker
from stepbot.step import KERNEL
from stepbot.step.exchange.input_files import input_digest

from .conversion import Options

if TYPE_CHECKING:
    from stepbot.runtime.fork_server import ForkServer

_STEP = re.compile(r"""^step:[ \t]*(?:"([^"\n]+)"|'([^'\n]+)'|([^\s"'#][^\n#]*))""", re.MULTILINE)
_LARGEST_SIDECAR = 1 << 20


def started_kernel(sidecar: Path, options: Options) -> Worker | None:
    """A process that is loading the kernel; None if none will be needed, as far as can be determined."""
    step = options.step or _guessed_step(sidecar)
    if step is None or not is_file(step):
        return None
    if options.cache is not None and was_read(options.cache, input_digest(step) or ""):
        return None
    return Worker(KERNEL, memory_limit=options.memory_limit)


def started_server(options: Options) -> "ForkServer | None":
    """A process that will start the engines; None if there will be none, or if forking is not possible."""
    if not options.verify:
        return None
    from stepbot.engines.prestart import started_engine_server

    return started_engine_server()


def was_read(cache: Cache, content: str) -> bool:
    """Whether the cache has geometry of a STEP with this hash, for any read options."""
    return cache.get(_read_key(content)) is not None


def note_read(cache: Cache | None, content: str) -> None:
    """Record that the cache has geometry of a STEP with this hash."""
    if cache is not None:
        cache.put(_read_key(content), b"")


def _read_key(content: str) -> str:
    return Digest("was read").add(environment(), content).key


def _guessed_step(sidecar: Path) -> Path | None:
    try:
        with open_regular(sidecar) as file:
            text = file.read(_LARGEST_SIDECAR).decode("utf-8-sig", "replace")
    except OSError:
        return None
    match = _STEP.search(text)
    return sidecar.parent / (match[1] or match[2] or match[3]).strip() if match is not None else None
