"""The axis of a clicked face."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.features.axes import axis_faces, choose, lines
from stepbot.step.reader import start_reading
from stepbot.viewing.joining import clicked_face
from tests.parts import write_cone, write_hinge


def read(path: Path) -> Assembly:
    """The assembly of a STEP file."""
    assembly = start_reading(path, ReadOptions()).finish(Diagnostics())
    assert assembly is not None
    return assembly


@pytest.fixture
def hinge(tmp_path: Path) -> Assembly:
    """Two plates on a pin."""
    path = tmp_path / "hinge.step"
    write_hinge(path)
    return read(path)


@pytest.mark.slow
def test_every_triangle_of_a_cylinder_gives_its_own_axis(hinge: Assembly) -> None:
    """Each triangle whose corners lie on a cylinder, rounded as in a drawing, gives an axis through the cylinder's."""
    clicked = 0
    for component in hinge.components:
        if component.body < 0:
            continue
        body = hinge.bodies[component.body]
        for corners in body.mesh.vertices[body.mesh.faces]:
            found = clicked_face(hinge, component.index, np.round(corners, 5).tolist())
            if found is None:
                continue
            clicked += 1
            face, _ = found
            arm = corners - np.array(face.point)
            radii = np.linalg.norm(np.cross(arm, face.direction), axis=1)
            assert radii == pytest.approx(face.radius, abs=1e-6)
    assert clicked > 20


def test_flat_faces_have_no_axis(hinge: Assembly) -> None:
    """A triangle of the largest flat face."""
    component = next(one for one in hinge.components if one.body >= 0)
    body = hinge.bodies[component.body]
    corners = body.mesh.vertices[body.mesh.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert clicked_face(hinge, component.index, corners[int(areas.argmax())].tolist()) is None


def test_origin_selects_the_axis(hinge: Assembly) -> None:
    """Resolving the origin as a sidecar does selects a line through the clicked cylinder's axis."""
    for component in hinge.components:
        if component.body < 0:
            continue
        body = hinge.bodies[component.body]
        for corners in body.mesh.vertices[body.mesh.faces][::7]:
            found = clicked_face(hinge, component.index, corners.tolist())
            if found is None:
                continue
            radius, (face, origin) = None, found
            if "radius: " in origin:
                radius = float(origin.split("radius: ")[1].split(" mm")[0]) / 1e3
            chosen = choose(lines(axis_faces(hinge, [component.index]), radius), selected=radius is not None).line
            if "near: " in origin:
                continue  # tested where lines are chosen
            assert chosen is not None
            assert chosen.distance_to(tuple(component.X_WC.apply(face.point).tolist())) < 1e-5


@pytest.mark.slow
def test_cone(tmp_path: Path) -> None:
    """The side of a cone gives its axis; its flat ends give none."""
    path = tmp_path / "cone.step"
    write_cone(path)
    assembly = read(path)
    component = next(one for one in assembly.components if one.body >= 0)
    body = assembly.bodies[component.body]
    kinds = set()
    for corners in body.mesh.vertices[body.mesh.faces]:
        found = clicked_face(assembly, component.index, corners.tolist())
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        is_end = abs(normal[2]) > 0.999 * np.linalg.norm(normal)
        assert (found is None) == is_end
        kinds.add(None if found is None else found[0].cone)
    assert kinds == {None, True}
