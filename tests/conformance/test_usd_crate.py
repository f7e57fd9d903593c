"""Binary layers, read by USD's library, which shares no code with the writer."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.formats.usd.crate import CrateAttribute, CratePrim, Ints, crate

pxr = pytest.importorskip("pxr", reason="usd-core is not installed")

from pxr import Sdf, Usd  # noqa: E402

RANDOM = np.random.default_rng(20)
INTEGERS = {
    "one": [7],
    "alike": [3] * 1000,
    "rising": list(range(100)),
    "bytes": RANDOM.integers(-60, 60, 1001).tolist(),
    "words": RANDOM.integers(-(2**14), 2**14, 1002).tolist(),
    "limits of a byte": [0, 127, -1, 127, 255, 127, 0, -129, 0] * 3,
    "limits of a word": [0, 32767, -1, 32767, 0, -32769, 0] * 3,
    "wide": RANDOM.integers(-(2**31), 2**31, 1003).tolist(),
    "limits": [2**31 - 1, -(2**31)] * 20,
    "fifteen": RANDOM.integers(0, 9999, 15).tolist(),
    "sixteen": RANDOM.integers(0, 9999, 16).tolist(),
    "blocks of LZ4": RANDOM.integers(-(2**31), 2**31, 70_000).tolist(),
}


def opened(top: CratePrim, folder: Path) -> Usd.Stage:
    """The stage of a layer."""
    file = folder / "layer.usdc"
    file.write_bytes(crate({"metersPerUnit": 0.001, "upAxis": "Z"}, "Größe: µm", top))
    return Usd.Stage.Open(str(file))


@pytest.mark.parametrize("name", INTEGERS)
def test_integers_are_read_back(name: str, tmp_path: Path) -> None:
    """Differences of every size, short arrays, which are not packed, and ones of several packed bytes."""
    values: Ints = np.array(INTEGERS[name], np.int32)
    stage = opened(CratePrim("Mesh", "a", (CrateAttribute("faceVertexIndices", "int[]", values),)), tmp_path)
    assert list(stage.GetPrimAtPath("/a").GetAttribute("faceVertexIndices").Get()) == INTEGERS[name]


@pytest.mark.parametrize("length", [0, 1, 14, 15, 16, 269, 270, 271, 524, 525, 526, 5000])
def test_long_texts_are_read_back(length: int, tmp_path: Path) -> None:
    """Blocks of LZ4 state the number of literals in 4 bits and bytes of 255."""
    name = "n" * (length + 1)
    stage = opened(CratePrim("Scope", name), tmp_path)
    assert stage.GetDefaultPrim().GetName() == name


def test_prims_attributes_and_metadata_are_read_back(tmp_path: Path) -> None:
    """A tree with siblings after children, attributes before children, and equal values in several places."""
    points = RANDOM.normal(size=(50, 3)).astype(np.float32)
    mesh = CratePrim(
        "Mesh",
        "mesh",
        (
            CrateAttribute("extent", "float3[]", np.zeros((0, 3), np.float32)),
            CrateAttribute("normals", "normal3f[]", points, interpolation="uniform"),
            CrateAttribute("points", "point3f[]", points),
            CrateAttribute("subdivisionScheme", "token", "none", uniform=True),
        ),
    )
    inner = CratePrim("Xform", "b", (CrateAttribute("purpose", "token", "guide"),), (mesh, CratePrim("Scope", "last")))
    last = CratePrim("Xform", "c", (), (mesh,))
    stage = opened(CratePrim("Xform", "top", (), (CratePrim("Scope", "a"), inner, last)), tmp_path)
    layer = stage.GetRootLayer()
    assert (layer.documentation, layer.defaultPrim) == ("Größe: µm", "top")
    assert layer.pseudoRoot.GetInfo("metersPerUnit") == 0.001
    assert [str(prim.GetPath()) for prim in stage.Traverse()] == [
        "/top", "/top/a", "/top/b", "/top/b/mesh", "/top/b/last", "/top/c", "/top/c/mesh",
    ]  # fmt: skip
    assert stage.GetPrimAtPath("/top/b").GetAttribute("purpose").Get() == "guide"
    for parent in "bc":
        prim = stage.GetPrimAtPath(f"/top/{parent}/mesh")
        assert prim.GetTypeName() == "Mesh"
        np.testing.assert_array_equal(prim.GetAttribute("points").Get(), points)
        np.testing.assert_array_equal(prim.GetAttribute("normals").Get(), points)
        assert len(prim.GetAttribute("extent").Get()) == 0
        assert prim.GetAttribute("normals").GetMetadata("interpolation") == "uniform"
        assert prim.GetAttribute("subdivisionScheme").Get() == "none"
        assert prim.GetAttribute("subdivisionScheme").GetVariability() == Sdf.VariabilityUniform
        assert not prim.GetAttribute("points").IsCustom()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_must_be_finite(value: float) -> None:
    """Meshes with NaN are faults of the program."""
    points = np.array([[0.0, value, 0.0]], np.float32)
    with pytest.raises(ValueError, match="NaN"):
        crate({}, "", CratePrim("Mesh", "a", (CrateAttribute("points", "point3f[]", points),)))


def test_text_of_the_layer_is_what_usd_writes_for_it(tmp_path: Path) -> None:
    """A layer that USD writes in its binary format has the same text as ours."""
    points = RANDOM.normal(size=(500, 3)).astype(np.float32)
    faces = RANDOM.integers(0, 500, 2000).astype(np.int32)
    attributes = (CrateAttribute("faceVertexIndices", "int[]", faces), CrateAttribute("points", "point3f[]", points))
    stage = opened(CratePrim("Mesh", "mesh", attributes), tmp_path)
    layer = stage.GetRootLayer()  # which expires with the stage
    assert layer.Export(str(tmp_path / "theirs.usdc"))
    theirs = Sdf.Layer.FindOrOpen(str(tmp_path / "theirs.usdc"))
    assert theirs.ExportToString() == layer.ExportToString()
    assert layer.GetFileFormat().formatId == theirs.GetFileFormat().formatId == "usdc"
