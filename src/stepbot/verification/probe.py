"""Inspects files before they are compared: their joints, and the correspondence between files."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines import Engine, engines_for
from stepbot.engines.file_references import openable
from stepbot.engines.observation import Observation, Quantity, Request
from stepbot.geometry.spatial import Pose
from stepbot.robot.renaming import NewNames
from stepbot.runtime.worker import RemoteError, WorkerDied, Workers

from .chains import Chain, Edge, chain, coordinates, is_known, unlike_edges
from .correspondence import Correspondence, match
from .counterparts import with_new_names
from .deviation import tolerance
from .naming import Naming, naming
from .stand_ins import without_stand_ins

Observe = Callable[[Engine, Request], Observation | None]
"""Runs an engine; None if it fails: it will be run again later, and its failure reported then."""


def in_a_process(workers: Workers) -> Observe:
    """Runs engines, each in a separate process."""

    def observe(engine: Engine, request: Request) -> Observation | None:
        try:
            seen: Observation = workers.call(engine.observe_function, request)
        except (RemoteError, WorkerDied):
            return None
        return seen

    return observe


class Probed(Struct, frozen=True, eq=False):
    """The observation of the first engine that can load a file; the others run later."""

    seen: Observation
    """With the poses of the links with all joints at 0."""
    asked: Request
    naming: Naming
    engine: Engine

    def renamed(self, names: NewNames) -> "Probed":
        """The same of a file with new names."""
        seen = with_new_names(self.seen, names)
        return replace(self, seen=seen, naming=naming(seen))


class Probe(Struct, frozen=True):
    """Runs one engine for a file."""

    observe: Observe

    def files(self, formats: Mapping[Path, str], places: Mapping[Path, Path]) -> dict[Path, Probed]:
        """The content of each file that an engine can load, by path; engines find it at its place."""
        return {path: seen for path, name in formats.items() if (seen := self._look(places[path], name))}

    def _look(self, path: Path, written_in: str) -> Probed | None:
        asked = Request(str(openable(path)), written_in, configurations=({},), simulate=0.0)
        for engine in sorted(engines_for(written_in), key=lambda engine: engine.probing_order):
            if engine.available() is None:
                seen = self.observe(engine, asked)
                if seen is not None:
                    seen = without_stand_ins(seen)
                    return Probed(seen, asked, naming(seen), engine)
        return None

    def correspondence(self, first: Probed, other: Probed) -> Correspondence:
        """Correspondence of the joints of two files, where the files represent them differently."""
        pairs = [
            (a, b)
            for a, b in unlike_edges(first.seen, other.seen)
            if is_known(a, first.naming) and is_known(b, other.naming)
        ]
        if not pairs:
            return Correspondence(())
        ours = self._chains(first, [a for a, _ in pairs])
        theirs = self._chains(other, [b for _, b in pairs])
        if ours is None or theirs is None:
            return Correspondence(())
        accuracy = tolerance((first.engine.name, other.engine.name), Quantity.POSES).absolute
        return Correspondence(tuple(match(a, b, accuracy) for a, b in zip(ours, theirs, strict=True)))

    def _chains(self, probed: Probed, edges: Sequence[Edge]) -> list[Chain] | None:
        """Motion of the links when joints of edges move one by one, by one unit; None if the engine fails now."""
        names = [name for edge in edges for name in coordinates(edge, probed.naming)]
        request = replace(
            probed.asked,
            configurations=({}, *({name: 1.0} for name in names)),
            balls=probed.naming.balls,
            universals=probed.naming.universals,
        )
        seen = self.observe(probed.engine, request)
        if seen is None or len(seen.poses) != 1 + len(names):
            return None
        moved = dict(zip(names, seen.poses[1:], strict=True))
        return [_chain(edge, probed.naming, seen.poses[0], moved) for edge in edges]


def _chain(edge: Edge, naming: Naming, at_zero: Mapping[str, Pose], moved: Mapping[str, Mapping[str, Pose]]) -> Chain:
    def X_PC(poses: Mapping[str, Pose]) -> Pose:
        return poses[edge.parent].inverse() @ poses[edge.child]

    return chain(edge, naming, {name: X_PC(moved[name]) for name in coordinates(edge, naming)}, X_PC(at_zero))
