"""Time from a save of a sidecar until the page gets the changed robot, as `stepbot watch` and `view --edit` serve it.

Saves come in a pace: while what was shown is being proven, or after that.
"""

import re
import subprocess
import threading
import time
import urllib.request
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from queue import SimpleQueue
from statistics import median
from typing import Any

from .contenders import STEPBOT, Case

_PATIENCE = 60.0
_PACES = (1.5, 6.0)
"""Seconds between two saves."""
_ADDRESS = re.compile(r"http://\S+")


def add_command(commands: Any, case_of: Callable[[Path, None, Path], Case]) -> None:
    """Add the command, given what makes the case of a sidecar in a folder."""
    added = commands.add_parser("live", help="seconds from a save to the page of `watch` and `view --edit`")
    added.add_argument("sidecar", type=Path)
    added.add_argument("-n", "--rounds", type=int, default=10, metavar="N", help="saves in each pace [default: 10]")
    added.set_defaults(run=lambda one, place: print(*times(case_of(one.sidecar, None, place), one.rounds), sep="\n"))


def times(case: Case, rounds: int) -> Iterator[str]:
    """A line for each command and pace: the median and the longest time [s]."""
    for arguments in (("watch",), ("view", "--edit")):
        for pace in _PACES:
            taken = list(_times(case, arguments, pace, rounds, case.environment))
            name = " ".join(arguments)
            yield f"{name}, a save every {pace:g} s: median {median(taken):.2f} s, longest {max(taken):.2f} s"


def seconds_to_page(case: Case, environment: Mapping[str, str], rounds: int) -> Iterator[float]:
    """Seconds from a save to the page of ``view --edit``, with time between saves to prove what was shown."""
    return _times(case, ("view", "--edit"), _PACES[-1], rounds, environment)


def _times(
    case: Case, arguments: Sequence[str], pace: float, rounds: int, environment: Mapping[str, str]
) -> Iterator[float]:
    command = [*STEPBOT, *arguments, "--no-open", str(case.sidecar)]
    output, errors = subprocess.PIPE, subprocess.STDOUT
    with subprocess.Popen(command, stdout=output, stderr=errors, text=True, env=environment) as served:
        try:
            assert served.stdout is not None
            url = next(found[0] for line in served.stdout if (found := _ADDRESS.search(line)))
            threading.Thread(target=served.stdout.read, daemon=True).start()
            shown: SimpleQueue[float] = SimpleQueue()
            threading.Thread(target=_listen, args=(url, shown), daemon=True).start()
            shown.get(timeout=_PATIENCE)  # the page gets the robot as it is at first
            for _ in range(rounds):
                time.sleep(pace)
                saved = time.monotonic()
                case.edit()
                yield shown.get(timeout=_PATIENCE) - saved
        finally:
            served.terminate()


def _listen(url: str, shown: "SimpleQueue[float]") -> None:
    """Note when the page gets a robot."""
    with urllib.request.urlopen(f"{url}events") as events:
        for line in events:
            if line.strip() == b"event: scene":
                shown.put(time.monotonic())
