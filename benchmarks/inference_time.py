"""Time to draft ever larger assemblies: copies of one robot in a row, as in a cell of many arms."""

import os
import time

from msgspec.structs import replace

from stepbot.draft.draft_robot import infer
from stepbot.draft.stops.stops import with_stops
from stepbot.geometry.spatial import Pose
from stepbot.step.assembly import Assembly

_GAP = 1.5
"""Distance between copies, as a share of the size of one: nothing touches."""


def in_a_row(assembly: Assembly, copies: int) -> Assembly:
    """Copies side by side along x, below one root; paths of the first stay."""
    low, high = assembly.bounds(0) or ((0.0,) * 3, (0.0,) * 3)
    step = _GAP * (high[0] - low[0])
    root, *below = assembly.components
    components = [root]
    for copy in range(copies):
        offset = copy * len(below)
        shift = Pose(position=(copy * step, 0.0, 0.0))
        suffix = f"#{copy + 1}" if copy else ""
        components += [
            replace(
                one,
                index=one.index + offset,
                parent=one.parent + offset if one.parent else 0,
                segment=one.segment if one.parent else f"{one.segment}{suffix}",
                path=one.path.replace("/", f"{suffix}/", 1) if "/" in one.path else f"{one.path}{suffix}",
                X_WC=shift @ one.X_WC,
            )
            for one in below
        ]
    return replace(assembly, components=tuple(components))


def drafting_time(assembly: Assembly, copies: int) -> str:
    """Parts, joints, and the elapsed and processor time [s] of the draft with the stops of its joints."""
    row = in_a_row(assembly, copies)
    parts = sum(one.body >= 0 for one in row.components)
    wall, cpu = time.perf_counter(), _processor_time()
    draft = infer(row, "row")
    drafted = _processor_time()
    stopped = with_stops(draft, row)
    wall, end = time.perf_counter() - wall, _processor_time()
    found = sum(bool(joint.stops) for joint in stopped.joints)
    drawn = f"{parts:5} parts: {len(draft.links)} links, {len(draft.joints)} joints, {found} with stops"
    times = f"{wall:.2f} s, processor {end - cpu:.2f} s, of which stops {end - drafted:.2f} s"
    return f"{copies:3} copies, {drawn}; {times}"


def _processor_time() -> float:
    """[s] of this process and of its children that have ended."""
    return sum(os.times()[:4])
