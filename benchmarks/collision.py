"""Collision geometry: pieces against CoACD's on the same solids, time and memory of a set.

Each solid of a STEP file is decomposed by stepbot, to 0.975 of its pieces' hulls in at most 256 pieces, and by CoACD
with its defaults; both in processes of their own, one after the other.
"""

import json
import multiprocessing
import resource
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.solids.collision_scores import UnscoredSolids, collision_scores
from stepbot.geometry.solids.collision_sets import CollisionRequest, collision_sets
from stepbot.geometry.solids.manifolds import convex_hull
from stepbot.geometry.solids.primitive_fits import RoundFace
from stepbot.geometry.solids.unions import PlacedShape, PlacedSolid
from stepbot.geometry.spatial import IDENTITY
from stepbot.step.assembly import Body

CLOSE, MANY = 0.975, 256
"""Share of the hulls that a solid has to fill, and maximum number of pieces, in the comparison."""
_PATIENCE = 1800.0
"""Time limit [s] of one solid."""
_NO_RESULT = f"none in {_PATIENCE:g} s | | |"


def compare_pieces(bodies: list[Body], counts: list[int]) -> str:
    """A table of pieces, intersection over union, time and memory on every closed solid that is used.

    CoACD's columns are there where it is installed. Means are over the solids of which both have a result.
    """
    contenders = {"stepbot": _stepbot}
    if find_spec("coacd") is not None:
        contenders["CoACD"] = _coacd
    columns = " | ".join(f"{name}: pieces | IoU | s | MB" for name in contenders)
    lines = [f"| solid | triangles | {columns} |", "| --- " * (2 + 4 * len(contenders)) + "|"]
    found: dict[str, list[Result]] = {name: [] for name in contenders}
    for index, (body, count) in enumerate(zip(bodies, counts, strict=True)):
        if not body.watertight or not len(body.mesh.faces) or not count:
            continue
        made = {name: _isolated(decompose, body) for name, decompose in contenders.items()}
        cells = [_NO_RESULT if one is None else _cells(one) for one in made.values()]
        lines.append(f"| {index} | {len(body.mesh.faces)} | {' | '.join(cells)} |")
        results = {name: one for name, one in made.items() if one is not None}
        if len(results) == len(contenders):
            for name, one in results.items():
                found[name].append(one)
    for name, rows in found.items():
        if rows:
            pieces, mean, seconds, memory = np.array(rows).T
            sums = f"{pieces.sum():.0f} pieces, {seconds.sum():.1f} s, at most {memory.max():.0f} MB"
            lines.append(f"{name}: {len(rows)} solids, mean IoU {mean.mean():.4f}, {sums}")
    return "\n".join(lines)


def _cells(one: "Result") -> str:
    return f"{one[0]:.0f} | {one[1]:.3f} | {one[2]:.2f} | {one[3]:.0f}"


def _stepbot(body: Body) -> list[TriMesh]:
    bores = [
        RoundFace(np.array(f.point), np.array(f.direction), f.radius) for f in body.axis_faces if f.bore and not f.cone
    ]
    wanted = CollisionRequest((PlacedSolid(body.mesh, IDENTITY),), 0.0, (), tuple(bores), False, CLOSE, MANY, 10_000)
    (made,) = collision_sets([wanted])
    return [shape.geometry for shape in made.shapes if isinstance(shape.geometry, TriMesh)]


def _coacd(body: Body) -> list[TriMesh]:
    import coacd

    coacd.set_log_level("off")
    pieces = coacd.run_coacd(coacd.Mesh(body.mesh.vertices, body.mesh.faces))
    return [hull for vertices, _ in pieces if (hull := convex_hull(np.array(vertices))) is not None]


Result = tuple[float, float, float, float]
"""Pieces, intersection over union, time [s], peak memory [MB]."""


def _isolated(decompose: Callable[[Body], list[TriMesh]], body: Body) -> Result | None:
    """The result in a new process; None if it takes too long or dies."""
    context = multiprocessing.get_context("spawn")
    answers: Any = context.SimpleQueue()
    process = context.Process(target=_measured, args=(decompose, body, answers))
    process.start()
    process.join(_PATIENCE)
    if process.is_alive():
        process.kill()
        process.join()
    if process.exitcode != 0 or answers.empty():
        return None
    result: Result = answers.get()
    return result


def _measured(decompose: Callable[[Body], list[TriMesh]], body: Body, answers: Any) -> None:
    start = time.process_time()
    pieces = decompose(body)
    seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    shapes = tuple(PlacedShape(piece, IDENTITY) for piece in pieces)
    (score,) = collision_scores([UnscoredSolids((PlacedSolid(body.mesh, IDENTITY),), 0.0, shapes)])
    answers.put((float(len(pieces)), score.iou or 0.0, seconds, peak))


def shapes_of(report: Path) -> str:
    """The collision shapes in a ``report.json``, in words."""
    links = json.loads(report.read_text(encoding="utf-8"))["collision_shapes"]
    shapes = sum(sum(link["shapes"].values()) for link in links)
    least = min((link["iou"] for link in links if link["iou"] is not None), default=None)
    return f"{shapes} shapes, {sum(link['vertices'] for link in links)} vertices, IoU at least {least}"
