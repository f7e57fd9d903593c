"""Definitions expanded into components: poses, colours, materials, and transformations that are not poses."""

import numpy as np
import pytest

from stepbot.geometry.spatial import Array, rotation_about
from stepbot.step.structure import tree
from stepbot.step.structure.source import NONE, BodySource, Child, Definition, StepMaterial
from stepbot.step.structure.tree import Tree, Variant, grow
from tests.conftest import ReadDiagnostics

RED, GREEN, BLUE, GREY = ((1.0, 0, 0, 1.0), (0, 1.0, 0, 1.0), (0, 0, 1.0, 1.0), (0.5, 0.5, 0.5, 1.0))
STEEL = StepMaterial("steel", 7850.0)


def body(color: tuple[float, float, float, float] | None = None) -> BodySource:
    """A body of any shape."""
    return BodySource(None, 1e-3, color, {})


def at(x: float, linear: Array | None = None) -> Array:
    """A transformation to (x, 0, 0)."""
    X = np.eye(4)
    X[:3, :3] = np.eye(3) if linear is None else linear
    X[0, 3] = x
    return X


def expand(definitions: list[Definition], diagnostics: ReadDiagnostics, *roots: int) -> Tree | None:
    """The tree of definitions whose products are all of steel except the first."""
    materials = [StepMaterial()] + [STEEL if d.product != NONE else StepMaterial() for d in definitions[1:]]
    return grow(definitions, roots or (0,), materials, "x.step", diagnostics)


def test_poses_add_up(diagnostics: ReadDiagnostics) -> None:
    """A component's pose is the product of those above it and its own."""
    quarter = rotation_about((0, 0, 1), np.pi / 2)
    definitions = [
        Definition(0, "root", children=[Child(1, "a", at(1.0, quarter)), Child(1, "b", at(5.0))]),
        Definition(1, "sub", children=[Child(2, "c", at(2.0, quarter))]),
        Definition(2, "part", bodies=[body()]),
    ]
    grown = expand(definitions, diagnostics)
    assert grown is not None
    assert [c.path for c in grown.components] == [".", "a", "a/part", "b", "b/part"]
    assert grown.components[2].X_WC.position == pytest.approx((1.0, 2.0, 0.0))
    assert pytest.approx(np.diag([-1.0, -1.0, 1.0])) == grown.components[2].X_WC.R
    assert grown.components[4].X_WC.position == pytest.approx((7.0, 0.0, 0.0))
    assert (grown.definition_count, grown.variants) == (3, (Variant(2, 0),))


def test_mirrored_twice_is_not_mirrored(diagnostics: ReadDiagnostics) -> None:
    """A part mirrored twice is the part itself; mirrored once it is a variant."""
    mirror = np.diag([-1.0, 1.0, 1.0])
    definitions = [
        Definition(0, "root", children=[Child(1, "a", at(1.0, mirror))]),
        Definition(1, "sub", children=[Child(2, "plain", at(2.0)), Child(2, "mirrored", at(3.0, mirror))]),
        Definition(2, "part", bodies=[body()]),
    ]
    grown = expand(definitions, diagnostics)
    assert grown is not None
    assert grown.variants == (Variant(2, 0, True), Variant(2, 0))
    for component in grown.components:
        assert np.linalg.det(component.X_WC.R) == pytest.approx(1.0)
    # The variant is mirrored at z = 0: frame and variant together are the mirror image in x.
    plain = grown.components[2].X_WC
    assert plain.R @ np.diag([1.0, 1.0, -1.0]) == pytest.approx(mirror)
    assert plain.position == pytest.approx((-1.0, 0.0, 0.0))


def test_scaled(diagnostics: ReadDiagnostics) -> None:
    """A uniformly scaled occurrence is a variant."""
    definitions = [
        Definition(0, "root", children=[Child(1, "a", at(1.0, 2.5 * np.eye(3)))]),
        Definition(1, "part", bodies=[body()]),
    ]
    grown = expand(definitions, diagnostics)
    assert grown is not None
    assert grown.variants == (Variant(1, 0, False, 2.5),)
    assert pytest.approx(np.eye(3)) == grown.components[1].X_WC.R


@pytest.mark.parametrize("linear", [np.diag([1.0, 1.0, 2.0]), np.eye(3) + np.eye(3, k=1), np.zeros((3, 3))])
def test_what_is_no_pose(linear: Array, diagnostics: ReadDiagnostics) -> None:
    """Uneven scaling and shear are errors that name the component."""
    definitions = [
        Definition(0, "root", children=[Child(1, "a", at(1.0, linear))]),
        Definition(1, "part", bodies=[body()]),
    ]
    assert expand(definitions, diagnostics) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB214"
    assert diagnostic.message.startswith("'part': ")


def test_colours_nearest_first(diagnostics: ReadDiagnostics) -> None:
    """Colour precedence: occurrence, body, part, assembly above."""
    definitions = [
        Definition(0, "root", children=[Child(1, "a", at(0.0), RED), Child(1, "b", at(1.0)), Child(2, "c", at(2.0))]),
        Definition(1, "two bodies", BLUE, bodies=[body(GREEN), body()]),
        Definition(2, "sub", GREY, children=[Child(3, "d", at(0.0))]),
        Definition(3, "plain", bodies=[body()]),
    ]
    grown = expand(definitions, diagnostics)
    assert grown is not None
    assert {c.path: c.color for c in grown.components} == {
        ".": None,
        "a": RED,
        "a/body#1": RED,
        "a/body#2": RED,
        "b": BLUE,
        "b/body#1": GREEN,
        "b/body#2": BLUE,
        "sub": GREY,
        "sub/plain": GREY,
    }


def test_materials_reach_bodies_but_not_components(diagnostics: ReadDiagnostics) -> None:
    """Bodies of a part, and those created by the kernel, have its material; a product below has its own or none."""
    definitions = [
        Definition(0, "root", children=[Child(1, "a", at(0.0)), Child(4, "e", at(0.0))]),
        Definition(1, "part", children=[Child(2, "", at(0.0)), Child(3, "", at(0.0))]),
        Definition(NONE, "", bodies=[body()]),
        Definition(NONE, "", bodies=[body()]),
        Definition(2, "two", bodies=[body(), body()]),
    ]
    grown = expand(definitions, diagnostics)
    assert grown is not None
    assert [c.path for c in grown.components] == [
        ".",
        "part",
        "part/body#1",
        "part/body#2",
        "two",
        "two/body#1",
        "two/body#2",
    ]
    assert [c.density for c in grown.components] == [None] + [7850.0] * 6
    assert grown.definition_count == 3


def test_empty_components_are_reported(diagnostics: ReadDiagnostics) -> None:
    """A product without content is a component, and one note lists all of them."""
    definitions = [
        Definition(0, "root", children=[Child(1, str(i), at(0.0)) for i in range(5)] + [Child(2, "p", at(0.0))]),
        Definition(1, "empty"),
        Definition(2, "part", bodies=[body()]),
    ]
    assert expand(definitions, diagnostics) is not None
    (diagnostic,) = diagnostics
    assert (diagnostic.code, diagnostic.severity) == ("SB216", "note")
    assert diagnostic.message == "5 components have no geometry: 'empty#1', 'empty#2', 'empty#3' and 2 more"


def test_several_roots_get_one_without_a_name(diagnostics: ReadDiagnostics) -> None:
    """The first level of a file without a common root is below an unnamed root."""
    definitions = [Definition(0, "one", bodies=[body()]), Definition(1, "two", bodies=[body()])]
    grown = expand(definitions, diagnostics, 0, 1)
    assert grown is not None
    assert [(c.path, c.product, c.parent) for c in grown.components] == [
        (".", "", -1),
        ("one", "one", 0),
        ("two", "two", 0),
    ]


def test_a_part_alone_is_the_root(diagnostics: ReadDiagnostics) -> None:
    """A file with one part has one component."""
    grown = expand([Definition(0, "part", bodies=[body()])], diagnostics)
    assert grown is not None
    assert [(c.path, c.product, c.body) for c in grown.components] == [(".", "part", 0)]


def test_trees_that_explode(diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch) -> None:
    """Assemblies that double twenty times are rejected by a diagnostic."""
    monkeypatch.setattr(tree, "MAX_COMPONENTS", 1000)
    definitions = [
        Definition(i, f"level {i}", children=[Child(i + 1, "a", at(0.0)), Child(i + 1, "b", at(1.0))])
        for i in range(20)
    ]
    definitions.append(Definition(20, "part", bodies=[body()]))
    assert expand(definitions, diagnostics) is None
    assert diagnostics.codes() == ["SB215"]


def test_deep_nesting(diagnostics: ReadDiagnostics) -> None:
    """Thousands of levels give a long path."""
    definitions = [Definition(i, "level", children=[Child(i + 1, "a", at(1e-3))]) for i in range(3000)]
    definitions.append(Definition(3000, "part", bodies=[body()]))
    grown = expand(definitions, diagnostics)
    assert grown is not None
    assert grown.components[-1].X_WC.position == pytest.approx((3.0, 0.0, 0.0))
