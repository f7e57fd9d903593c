"""MAPPED_ITEM with a transformation operator: translated, mirrored and scaled parts (ISO 10303-42)."""

import re
from pathlib import Path

import numpy as np
import pytest

from stepbot.geometry.spatial import Array
from tests import parts, solids
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here, read_quietly

BRACKET = (
    solids.box(40, 10, 10).at(20, 0, 0) + solids.box(10, 30, 10).at(35, 20, 0) + solids.box(10, 10, 50).at(35, 30, 30)
)


def write_mapped(path: Path, axes: tuple[str, str, str], scale: str, place: str = "(100.,0.,0.)") -> None:
    """A product that maps a bracket by an operator with these axes and scale, and this place [mm]."""
    parts.draw(path, parts.drawn("bracket", BRACKET))
    text = re.sub(r"\n\s*", "", path.read_text(encoding="utf-8")).replace(";", ";\n")
    brep = re.search(r"#(\d+)=ADVANCED_BREP_SHAPE_REPRESENTATION\('[^']*',\((#\d+),#\d+\),(#\d+)\)", text)
    application = re.search(r"#(\d+)=APPLICATION_CONTEXT\(", text)
    assert brep
    assert application
    entities = f"""\
#9001=PRODUCT_CONTEXT('',#{application[1]},'mechanical');
#9002=PRODUCT('shown','shown','',(#9001));
#9003=PRODUCT_DEFINITION_FORMATION('','',#9002);
#9004=PRODUCT_DEFINITION_CONTEXT('part definition',#{application[1]},'design');
#9005=PRODUCT_DEFINITION('design','',#9003,#9004);
#9006=PRODUCT_DEFINITION_SHAPE('','',#9005);
#9010=CARTESIAN_POINT('',{place});
#9011=DIRECTION('',{axes[0]});
#9012=DIRECTION('',{axes[1]});
#9013=DIRECTION('',{axes[2]});
#9020=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#9011,#9012,#9010,{scale},#9013);
#9021=REPRESENTATION_MAP({brep[2]},#{brep[1]});
#9022=MAPPED_ITEM('',#9021,#9020);
#9023=SHAPE_REPRESENTATION('',(#9022,{brep[2]}),{brep[3]});
#9024=SHAPE_DEFINITION_REPRESENTATION(#9006,#9023);
"""
    before, after = text.rsplit("ENDSEC;", 1)
    path.write_text(f"{before}{entities}ENDSEC;{after}", encoding="utf-8", newline="\n")


X, Y, Z, MINUS_X = "(1.,0.,0.)", "(0.,1.,0.)", "(0.,0.,1.)", "(-1.,0.,0.)"


@pytest.mark.parametrize(
    ("axes", "scale", "matrix"),
    [
        ((X, Y, Z), "1.", np.eye(3)),
        ((X, Y, Z), "$", np.eye(3)),
        ((Y, MINUS_X, Z), "1.", [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        ((MINUS_X, Y, Z), "1.", np.diag([-1.0, 1, 1])),
        ((X, Y, Z), "2.", 2 * np.eye(3)),
        ((MINUS_X, Y, Z), "0.5", np.diag([-0.5, 0.5, 0.5])),
    ],
    ids=["moved", "without scale", "turned", "mirrored", "scaled", "mirrored and scaled"],
)
def test_operator(axes: tuple[str, str, str], scale: str, matrix: Array, tmp_path: Path) -> None:
    """The mapped bracket is closed, with volume, centre and inertia of the transformed one."""
    path = tmp_path / "mapped.step"
    write_mapped(path, axes, scale)
    assembly = read_quietly(path)
    (component,) = (c for c in assembly.components if c.product == "shown")
    body = assembly.bodies[component.body]
    assert body.watertight
    assert body.exact is not None
    found = body.exact.unit_density.moved(component.X_WC)
    A = np.array(matrix, dtype=np.float64)
    size = abs(np.linalg.det(A)) ** (1 / 3)
    drawn = BRACKET.moments.in_metres()
    assert found.mass == pytest.approx(drawn.mass * size**3, rel=1e-9)
    assert found.com == pytest.approx(A @ drawn.com + [0.1, 0, 0], abs=1e-12)
    turned = A @ np.array(drawn.inertia) @ A.T * size**3
    assert np.abs(np.array(found.inertia) - turned).max() < 1e-9 * np.abs(turned).max()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_operator_far_from_the_origin(sign: float, tmp_path: Path) -> None:
    """Turned or mirrored, 1000 km away, where doubles are 1e-10 m apart: the bracket is where the file has it."""
    path = tmp_path / "mapped.step"
    place, A = (1e9 + 0.1, 2e9 + 0.3, -1e9 - 0.7), np.array([[0.6, -0.8 * sign, 0], [0.8, 0.6 * sign, 0], [0, 0, 1]])
    axes = [f"({','.join(map(str, column))})" for column in A.T.tolist()]
    write_mapped(path, (axes[0], axes[1], axes[2]), "1.", str(place))
    assembly = read_quietly(path)
    (component,) = (c for c in assembly.components if c.product == "shown")
    body = assembly.bodies[component.body]
    assert body.exact is not None
    com = body.exact.unit_density.moved(component.X_WC).com
    assert com == pytest.approx(A @ BRACKET.moments.in_metres().com + np.array(place) * 1e-3, abs=1e-8)


def test_an_axis_without_direction(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An operator that is not a transformation is a diagnostic."""
    path = tmp_path / "mapped.step"
    write_mapped(path, (X, Y, "(0.,0.,0.)"), "1.")
    assert read_here(path, diagnostics) is None
    assert diagnostics.codes() == ["SB205"]


@pytest.mark.parametrize("lost", ["#9011,#9012,#9010", "#9010,1.,#9013"])
def test_an_operator_that_names_something_else(lost: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An operator with a direction in place of a point, or vice versa, is an error without a traceback."""
    path = tmp_path / "mapped.step"
    write_mapped(path, (X, Y, Z), "1.")
    text = path.read_text(encoding="utf-8")
    assert lost in text
    path.write_text(text.replace(lost, lost.rpartition(",")[0] + ",#9021"), encoding="utf-8", newline="\n")
    assert read_here(path, diagnostics) is None
    assert all(d.severity != "error" or d.help for d in diagnostics)
    assert set(diagnostics.codes()) <= {"SB205", "SB221", "SB223"}
