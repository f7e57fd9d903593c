"""Component paths and globs match as documented, or report why not."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from stepbot.diagnostics import NOT_TEXT
from stepbot.step.assembly import Component
from stepbot.step.structure.naming import NamedComponent, assign_paths
from stepbot.step.structure.paths import ComponentPaths, escape, nearest_claim, plain_name, quoted


def _tree(*rows: tuple[str, str, str], bodies: bool = True) -> list[Component]:
    """Components from (parent path, product, occurrence), with canonical segments written by hand."""
    components = [Component(0, -1, "", ".", "robot", "robot", 1)]
    paths = {".": 0}
    for parent_path, product, occurrence in rows:
        parent = paths[parent_path]
        siblings = [c for c in components[1:] if c.parent == parent and c.product == product]
        total = sum(p == parent_path and name == product for p, name, _ in rows)
        ordinal = len(siblings) + 1
        base = escape(product) or "body"
        segment = base if total == 1 else f"{base}#{ordinal}"
        path = segment if parent == 0 else f"{components[parent].path}/{segment}"
        paths[path] = len(components)
        components.append(
            Component(len(components), parent, segment, path, product, occurrence, ordinal, by_ordinal_only=total > 1)
        )
    return components


ARM = _tree(
    (".", "base v3", "base v3:1"),
    ("base v3", "motor", "motor:1"),
    ("base v3/motor", "case", "case:1"),
    ("base v3/motor", "horn", "horn:1"),
    ("base v3", "bolt", "bolt:1"),
    (".", "gripper", "gripper:1"),
    ("gripper", "XL,XC-330 v1", "XL,XC-330 v1:1"),
    ("gripper/XL,XC-330 v1", "horn", "horn:1"),
    ("gripper", "bolt", "NAUO1"),
    ("gripper", "bolt", "NAUO1"),
    ("gripper", "a/b*c#2", ""),
    ("gripper", "", ""),
    ("gripper", "", ""),
)
PATHS = ComponentPaths(ARM)


def _paths(pattern: str) -> list[str]:
    binding = PATHS.find(pattern)
    assert not binding.problem, binding
    return [ARM[i].path for i in binding.topmost]


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        (".", ["."]),
        ("base", ["base v3"]),
        ("base v3", ["base v3"]),
        ("base v77", ["base v3"]),
        ("base v5:1", ["base v3"]),
        ("base:1/motor:1/horn", ["base v3/motor/horn"]),
        ("case", ["base v3/motor/case"]),
        ("motor/horn", ["base v3/motor/horn"]),
        ("XL,XC-330", ["gripper/XL,XC-330 v1"]),
        ("gripper/bolt", ["gripper/bolt#1", "gripper/bolt#2"]),
        ("gripper/bolt#2", ["gripper/bolt#2"]),
        ("NAUO1", ["gripper/bolt#1", "gripper/bolt#2"]),
        (r"gripper/a\/b\*c\#2", [r"gripper/a\/b\*c\#2"]),
        ("body", ["gripper/body#1", "gripper/body#2"]),
        ("gripper/body#2", ["gripper/body#2"]),
        ("**/bolt", ["base v3/bolt", "gripper/bolt#1", "gripper/bolt#2"]),
        ("**/bolt#1", ["base v3/bolt", "gripper/bolt#1"]),
        ("**/horn", ["base v3/motor/horn", "gripper/XL,XC-330 v1/horn"]),
        ("*/horn", []),
        ("gripper/*/horn", ["gripper/XL,XC-330 v1/horn"]),
        ("gripper/**/horn", ["gripper/XL,XC-330 v1/horn"]),
        ("**/XL*", ["gripper/XL,XC-330 v1"]),
        ("**/*", ["base v3", "gripper"]),
        ("**", ["base v3", "gripper"]),
        ("b*", ["base v3"]),
        ("base/**", ["base v3/motor", "base v3/bolt"]),
        ("**/motor/**", ["base v3/motor/case", "base v3/motor/horn"]),
        (r"**/*\**", [r"gripper/a\/b\*c\#2"]),
    ],
)
def test_binding(pattern: str, expected: list[str]) -> None:
    """Product or occurrence name, save counters, ordinals, escapes, suffixes and globs match as documented."""
    binding = PATHS.find(pattern)
    assert [ARM[i].path for i in binding.topmost] == expected
    assert binding.problem == ("" if expected else "unknown")


def test_a_glob_names_what_lies_below_another_match_too() -> None:
    """A glob returns all matches, for closer claims, and marks the topmost."""
    components = _tree((".", "arm", ""), ("arm", "arm plate", ""), ("arm", "bolt", ""))
    binding = ComponentPaths(components).find("**/arm*")
    assert binding.indices == (1, 2)
    assert binding.topmost == (1,)


def test_suffix_in_two_places_is_ambiguous() -> None:
    """A suffix that matches in two places is an error with both candidates."""
    binding = PATHS.find("horn")
    assert binding.problem == "ambiguous"
    assert binding.candidates == ("base v3/motor/horn", "gripper/XL,XC-330 v1/horn")
    assert binding.indices == ()


def test_exact_path_beats_suffix() -> None:
    """An exact path takes precedence over an equal suffix elsewhere."""
    components = _tree((".", "plate", ""), (".", "arm", ""), ("arm", "plate", ""))
    assert ComponentPaths(components).find("plate").indices == (1,)


def test_suffix_below_equal_siblings_is_one_place() -> None:
    """A segment without ``#n`` in a suffix matches all equal siblings."""
    components = _tree(
        (".", "hand", ""),
        ("hand", "finger", "f1"),
        ("hand", "finger", "f2"),
        ("hand/finger#1", "tip", ""),
        ("hand/finger#2", "tip", ""),
    )
    paths = ComponentPaths(components)
    assert [components[i].path for i in paths.find("finger/tip").indices] == ["hand/finger#1/tip", "hand/finger#2/tip"]
    assert paths.find("tip").problem == "ambiguous"
    assert [components[i].path for i in paths.find("f2/tip").indices] == ["hand/finger#2/tip"]


def test_one_component_is_needed() -> None:
    """Several matches are an error with a list where one component is required."""
    binding = PATHS.find_one("gripper/bolt")
    assert binding.problem == "ambiguous"
    assert binding.candidates == ("gripper/bolt#1", "gripper/bolt#2")
    assert [ARM[i].path for i in PATHS.find_one("gripper/bolt#1").indices] == ["gripper/bolt#1"]
    assert PATHS.find_one("**/horn").problem == "ambiguous"


def test_every_canonical_path_finds_its_component() -> None:
    """Every printed path selects its component."""
    for component in ARM:
        assert PATHS.find_one(component.path).indices == (component.index,)


def test_binding_by_ordinal_alone_is_fragile() -> None:
    """Only a path that depends on ``#n`` alone is fragile."""
    assert PATHS.find("gripper/bolt#2").fragile
    assert not PATHS.find("gripper/bolt").fragile
    assert not PATHS.find("base/bolt").fragile


@pytest.mark.parametrize(
    ("pattern", "hint"),
    [
        ("gripper/hron", "horn"),
        ("Base", "'base'"),
        ("grippr/bolt", "gripper"),
        ("base/horn", 'did you mean "base v3/motor/horn"?'),
        ("robot/gripper", 'paths begin below the root: "gripper"'),
        ("robot", 'the root itself is "."'),
        ("**/hrn", "horn"),
        ("hor*", "**/"),
        ("GRIP*", "upper and lower case differ: 'gripper'"),
    ],
)
def test_unknown_paths_get_help(pattern: str, hint: str) -> None:
    """An unknown path has the most likely remedy."""
    binding = PATHS.find(pattern)
    assert binding.problem == "unknown"
    assert any(hint in text for text in binding.help), binding.help


def test_suggestions_name_each_component_once() -> None:
    """A product and its only occurrence are one suggestion; the one with a number, if the path has one."""
    paths = ComponentPaths(_tree((".", "arm", "arm:1"), (".", "palm", "palm:1"), (".", "palm", "palm:2")))
    assert paths.find("amr").help == ("did you mean 'arm'?",)
    (help,) = paths.find("amr:1").help
    assert "'arm:1'" in help
    assert "'arm'" not in help
    assert paths.find("plam").help == ("did you mean 'palm' or 'palm:2' or 'palm:1'?",)


def test_a_single_part_matches_two_stars() -> None:
    """In an assembly of a single part a glob matches the part."""
    root = Component(0, -1, "", ".", "bracket", "bracket", 1, body=0)
    assert ComponentPaths([root]).find("**").indices == (0,)
    assert ComponentPaths([root]).find("*").problem == "unknown"


def test_below_lists_each_component_once() -> None:
    """Components below a path are listed once each."""
    below = PATHS.below([3, 1])
    assert below == [1, 2, 3, 4, 5]


def test_the_nearest_claim_holds() -> None:
    """A claim takes precedence over one above it, and over a later one on the same component."""
    values = nearest_claim(ARM, (((1,), "a"), ((4,), "b"), ((4, 1), "c")), "none")
    assert values[:7] == ["none", "a", "a", "a", "b", "a", "none"]


def test_quoting_is_yaml() -> None:
    """Quoted paths are read back unchanged."""
    from ruamel.yaml import YAML

    odd = ("two\nlines", "\x1b[31m 'red' \\/ \"quoted\"", "\u202ertl\u2028\x85\t\xa0", "\U000e0001tag")
    for path in ("plain", r"a\/b\#1", 'he said "no"', r"it's a \* star", "[XL,XC-330 v1]", "**/x", *odd):
        assert YAML(typ="safe").load(quoted(path)) == path
        assert quoted(path).isprintable()


_NAME = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=8)


@given(st.lists(_NAME, min_size=1, max_size=5))
@example([".", "\\.", "..", "\\/"])
@example(["Pe\x87a", "\0", "a\0b"])
def test_escaped_names_bind_to_themselves(names: list[str]) -> None:
    """The escaped form of any name matches that name only, and a sidecar may contain it."""
    plain = list(dict.fromkeys(filter(None, map(plain_name, names))))
    components = [Component(0, -1, "", ".", "", "", 1)]
    for i, name in enumerate(plain, start=1):
        components.append(Component(i, 0, escape(name), escape(name), name, "", 1))
        assert NOT_TEXT.search(escape(name)) is None
    paths = ComponentPaths(components)
    for i, _ in enumerate(plain, start=1):
        assert paths.find_one(components[i].path).indices == (i,)


_WORDS = st.sampled_from(["", "a", "b", "a v2", "a v3", "a:1", "a v2:2", "SOLID", "NAUO1", "a#1", "x/y", "*", "body"])


@given(st.lists(st.tuples(st.integers(0, 6), _WORDS, _WORDS), max_size=12))
def test_canonical_paths_of_any_tree_bind(rows: list[tuple[int, str, str]]) -> None:
    """For any product and occurrence names, each printed path selects its own component."""
    named = [NamedComponent(-1, "robot", "robot")]
    # Depth first, as in an assembly: each component is below the previous one or one of its ancestors.
    for up, product, occurrence in rows:
        parent = len(named) - 1
        for _ in range(up):
            parent = max(named[parent].parent, 0)
        named.append(NamedComponent(parent, product, occurrence))
    components = [
        Component(i, n.parent, c.segment, c.path, n.product, n.occurrence, c.ordinal, by_ordinal_only=c.by_ordinal_only)
        for i, (n, c) in enumerate(zip(named, assign_paths(named), strict=True))
    ]
    paths = ComponentPaths(components)
    for component in components:
        assert paths.find_one(component.path).indices == (component.index,)


@pytest.mark.slow
def test_thousands_of_components_are_found() -> None:
    """A glob and a name match all of ten thousand components."""
    rows = [(".", f"part {i % 200}", f"part {i % 200}:{i}") for i in range(10_000)]
    components = [Component(0, -1, "", ".", "robot", "", 1)]
    for i, (_, product, name) in enumerate(rows, start=1):
        components.append(Component(i, 0, escape(name), escape(name), product, name, (i - 1) // 200 + 1))
    paths = ComponentPaths(components)
    assert len(paths.find("**/part 1*").topmost) == 111 * 50
    assert len(paths.find("part 7").topmost) == 50
