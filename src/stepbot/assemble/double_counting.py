"""Reports mass counted twice by overlapping solids: a warning if it is significant for a link, else a note."""

from collections.abc import Mapping, Sequence

from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.mesh_worker import report_death
from stepbot.geometry.solids.overlapping import Overlaps, Pair
from stepbot.robot.model import ComponentMass
from stepbot.runtime.cache import Cache
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker, WorkerDied
from stepbot.step.structure.paths import quoted

from .binder import Binder, listed
from .claims import Claims
from .masses import MASS_TOLERANCE
from .overlaps import MAX_FACES, OverlapSearch

_CUT = "subtract one solid from the other in CAD"
_WEIGH = "or set a measured mass: `mass` in `parts`, or `inertial` on the link"


class DoubleCounting:
    """Overlaps in links with computed mass; a link with an ``inertial`` counts nothing twice."""

    def __init__(
        self,
        binder: Binder,
        claims: Claims,
        masses: Mapping[int, ComponentMass],
        max_faces: int = MAX_FACES,
        cache: Cache | None = None,
        process: Worker | None = None,
    ) -> None:
        """Start the search and return at once.

        Args:
            binder: Its collector receives SB512 to SB514, and SB902.
            claims: The link of each component.
            masses: Mass of every component that has a volume.
            max_faces: Maximum number of faces to intersect.
            cache: Cache for overlaps; None to disable it.
            process: Worker that searches; see :class:`.OverlapSearch`.
        """
        self._binder, self._masses = binder, masses
        links = [name for name, link in binder.document.links.items() if link.inertial is None]
        self._parts = {link: claims.parts_of(link) for link in links}
        self._search = OverlapSearch(binder.assembly, self._parts, masses, max_faces, cache, process)

    def report(self, timeout: float = DEFAULT_TIMEOUT) -> None:
        """Wait for the search to end, and report the overlaps.

        Args:
            timeout: Maximum waiting time [s].
        """
        try:
            found = self._search.result(timeout)
        except WorkerDied as death:
            report_death(death, "intersects solids", self._binder.span(("links",)), self._binder.found)
            return
        slight: dict[str, Overlaps] = {}
        for link, overlaps in found.items():
            total = exact_sum(self._masses[index].mass or 0.0 for index in self._parts[link] if index in self._masses)
            if overlaps.mass >= MASS_TOLERANCE * total > 0.0:
                _warn(self._binder, link, overlaps, total)
            elif overlaps.pairs:
                slight[link] = overlaps
        if slight:
            _note_slight(self._binder, slight)
        unchecked = [pair for overlaps in found.values() for pair in overlaps.unchecked]
        if unchecked:
            _note_unchecked(self._binder, unchecked)


def _warn(binder: Binder, link: str, overlaps: Overlaps, total: float) -> None:
    repeated = [pair for pair in overlaps.pairs if pair.is_repeated]
    again = [quoted(binder.path(max(pair.first, pair.second))) for pair in repeated[:1]]
    once = [f"{path} is duplicated at the same place: `parts: {{{path}: {{ignore: true}}}}`" for path in again]
    binder.report(
        "SB512",
        ("links", link),
        f"solids overlap: {_weight(overlaps.mass)} of {_weight(total)} are counted twice",
        help=(*once, _CUT, _WEIGH),
        notes=listed(tuple(f"{_names(binder, pair)}: {_measure(pair)}" for pair in overlaps.pairs)),
    )


def _note_slight(binder: Binder, slight: Mapping[str, Overlaps]) -> None:
    count = sum(len(overlaps.pairs) for overlaps in slight.values())
    pairs = f"{count} pairs of solids overlap" if count > 1 else "one pair of solids overlaps"
    notes = (
        f"link '{link}': {_weight(overlaps.mass)} are counted twice, most of it in "
        f"{_names(binder, overlaps.pairs[0])}: {_measure(overlaps.pairs[0])}"
        for link, overlaps in slight.items()
    )
    message = f"{binder.assembly.source}: {pairs} by less than a thousandth of their link's mass"
    binder.found.add("SB513", message, binder.span(("links",)), notes=listed(tuple(notes)))


def _note_unchecked(binder: Binder, pairs: Sequence[Pair]) -> None:
    heaviest_first = sorted(pairs, key=lambda pair: -pair.mass)
    count = f"{len(pairs)} pairs of solids were" if len(pairs) > 1 else "one pair of solids was"
    notes = (
        f"{_names(binder, pair)}: {pair.unchecked}; at most {_weight(pair.mass)} are counted twice"
        for pair in heaviest_first
    )
    message = f"{binder.assembly.source}: {count} not checked for overlaps"
    binder.found.add("SB514", message, binder.span(("links",)), notes=listed(tuple(notes)))


def _names(binder: Binder, pair: Pair) -> str:
    first, second = sorted((pair.first, pair.second))
    return f"{quoted(binder.path(first))} and {quoted(binder.path(second))}"


def _measure(pair: Pair) -> str:
    return f"{pair.volume * 1e9:.4g} mm^3, {_weight(pair.mass)}"


def _weight(mass: float) -> str:
    """A mass [kg], formatted for messages."""
    return f"{mass:.3g} kg" if mass >= 1.0 else f"{mass * 1e3:.3g} g"
