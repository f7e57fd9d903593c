"""Paths of the links of a draft, in assemblies with siblings of one name."""

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.link_claims import LinkClaims
from stepbot.step.structure.paths import ComponentPaths, nearest_claim
from tests.unit.assemble.workshop import Workshop, at


def _screwed(links: list[list[str]]) -> tuple[tuple[str, ...], ...]:
    """The paths of links whose parts are given by canonical path, in an assembly of plates with two screws each.

    The root is the first link. The paths are checked to claim exactly the parts of each link.
    """
    shop = Workshop()
    for x in (0.0, 50.0):
        plate = shop.group("plate", X_PC=at(x, 0, 0))
        shop.box("sheet", parent=plate)
        for y in (0.0, 10.0):
            shop.rod("M4", radius=2.0, length=10.0, X_PC=at(0, y, 0), parent=plate)
    for y in (0.0, 10.0, 20.0):
        shop.rod("M6", radius=3.0, length=20.0, X_PC=at(0, y, 20))
    assembly = shop.assembly
    of = {component.path: component.index for component in assembly.components}
    parts = [[of[path] for path in link] for link in links]
    claims = LinkClaims(assembly, parts, 0)
    paths = tuple(claims.paths(n) for n in range(len(links)))
    find = ComponentPaths(assembly.components).find
    owner = nearest_claim(assembly.components, [(find(p).indices, n) for n, some in enumerate(paths) for p in some], 0)
    assert all(owner[i] == n for n, members in enumerate(parts) for i in members)
    return paths


FIRST = ["plate#1/sheet", "plate#1/M4#1", "plate#1/M4#2"]
SECOND = ["plate#2/sheet", "plate#2/M4#1", "plate#2/M4#2"]
SCREWS = ["M6#1", "M6#2", "M6#3"]


def test_siblings_of_one_name_in_one_link_have_one_path() -> None:
    """All three screws are of the second link: their path needs no number."""
    assert _screwed([FIRST, SECOND + SCREWS]) == ((), ("plate#2", "M6"))


def test_divided_siblings_keep_their_numbers() -> None:
    """A path without the number would take the screw of the other link."""
    assert _screwed([[*FIRST, "M6#2"], [*SECOND, "M6#1", "M6#3"]]) == ((), ("plate#2", "M6#1", "M6#3"))


def test_numbers_stay_only_where_they_select() -> None:
    """Most of the first plate is of the second link, which the second plate is not; both sheets are of the root."""
    paths = _screwed([["plate#1/sheet", *SECOND, *SCREWS], FIRST[1:]])
    assert paths == (("plate/sheet",), ("plate#1",))


def test_all_numbers_of_a_path_go() -> None:
    """The screws of both plates are of the second link, and the plates' own sheets of the root."""
    paths = _screwed([["plate#1/sheet", "plate#2/sheet", *SCREWS], [*FIRST[1:], *SECOND[1:]]])
    assert paths == (("plate/sheet",), ("plate",))


def test_a_number_within_a_divided_subassembly_stays() -> None:
    """One screw of each plate is of the second link, the other of the third."""
    rest = ["plate#1/sheet", "plate#2/sheet", *SCREWS]
    paths = _screwed([rest, ["plate#1/M4#1", "plate#2/M4#1"], ["plate#1/M4#2", "plate#2/M4#2"]])
    assert paths == ((), ("plate/M4#1",), ("plate/M4#2",))


def test_what_only_wraps_the_whole_is_no_link() -> None:
    """An exporter's folder around everything, and the folder in it, are the whole; the group below is a part of it."""
    shop = Workshop()
    inner = shop.group("exported", shop.group("file"))
    shop.box("base", parent=inner)
    group = shop.group("arm", inner)
    for name in ("upper", "lower"):
        shop.box(name, parent=group)
    survey = Survey(shop.assembly, ALL_SOURCES)
    names = {one.index: one.path.rpartition("/")[2] for one in survey.assembly.components}
    assert {names.get(i) for i in survey.tops} == {None, names[0], "file", "exported"}


def test_bodies_of_the_whole_are_named_by_their_place() -> None:
    """Bodies of one product have no names but the product's: the root is the base, the others are numbered by it."""
    shop = Workshop()
    for name in ("", "", "103"):
        shop.box(name)
    assembly = shop.assembly
    claims = LinkClaims(assembly, [[1], [2], [3]], 0)
    survey = Survey(assembly, ALL_SOURCES)
    names = [claims.name([survey.parts[i]], is_root=i == 1)[0] for i in (1, 2, 3)]
    assert names == ["base", "body_2", "link_103"]
