"""A kernel process whose mesher hangs on a sphere, or dies over it."""

import itertools
import os
import threading
from typing import Any

from stepbot.step import worker
from stepbot.step.shapes.bodies import BodyRequest, ReadBody, read_body
from stepbot.step.structure.source import BodySource


def _is_sphere(made: ReadBody) -> bool:
    return not made.body.axis_faces and len(made.body.mesh.faces) > 12


def _hang(source: BodySource, request: BodyRequest) -> ReadBody:
    made = read_body(source, request)
    if _is_sphere(made):
        sum(itertools.repeat(0))  # endless native code, which no Python signal handler interrupts
    return made


def _die(source: BodySource, request: BodyRequest) -> ReadBody:
    made = read_body(source, request)
    if _is_sphere(made):
        os._exit(7)
    return made


def hanging(*arguments: Any) -> Any:
    """Read a file; spheres hang."""
    worker.read_body = _hang
    return worker.read(*arguments)


def leaving(*arguments: Any) -> Any:
    """End before there are bodies."""
    os._exit(3)


def dying(*arguments: Any) -> Any:
    """Read a file; spheres end the process."""
    worker.read_body = _die
    return worker.read(*arguments)


def hanging_beside_a_thread(*arguments: Any) -> Any:
    """Like ``hanging``, in a process that cannot fork safely."""
    threading.Thread(target=threading.Event().wait, daemon=True).start()
    return hanging(*arguments)
