"""Numbers of one word that say the same: MuJoCo, which compiles both, is the judge of orientations."""

from math import degrees, exp, pi, sqrt
from random import Random

import numpy as np
import pytest

from stepbot.engines.description.statements import Statement
from stepbot.verification.text import _RESHAPED, means_the_same

SEQUENCES = ("xyz", "XYZ", "zyx", "zxz", "ZYZ", "xYz")


def _angles(random: Random, sequence: str) -> list[float]:
    return [random.uniform(-pi, pi) for _ in sequence]


def _other_angles(random: Random, angles: list[float], sequence: str) -> list[float]:
    """Angles of the same rotation: turned on by whole turns, or through the other branch."""
    a, b, c = angles
    if random.random() < 0.5 and sequence in (sequence.lower(), sequence.upper()):
        middle = -b if sequence[0].lower() == sequence[2].lower() else pi - b
        a, b, c = a + pi, middle, c + pi
    return [angle + 2.0 * pi * random.randint(-2, 2) for angle in (a, b, c)]


def _quaternion(engine: object, attribute: str, values: list[float], sequence: str, unit: str) -> np.ndarray:
    text = " ".join(map(repr, values))
    model = engine.MjModel.from_xml_string(  # type: ignore[attr-defined]
        f'<mujoco><compiler angle="{unit}" eulerseq="{sequence}"/><worldbody>'
        f'<site {attribute}="{text}"/></worldbody></mujoco>'
    )
    return np.array(model.site_quat[0])


def _same_rotation(one: np.ndarray, other: np.ndarray) -> bool:
    return bool(min(np.abs(one - other).max(), np.abs(one + other).max()) < 1e-9)


@pytest.mark.mujoco
@pytest.mark.parametrize("seed", range(40))
def test_orientations_mean_what_mujoco_compiles(seed: int) -> None:
    """Other words for one orientation mean the same, and another number never does."""
    mujoco = pytest.importorskip("mujoco")
    random = Random(seed)
    sequence, unit = random.choice(SEQUENCES), random.choice(("degree", "radian"))
    said = {
        f"mujoco/compiler@{name}": Statement("", value, read=True)
        for name, value in (("angle", unit), ("eulerseq", sequence))
    }
    angles = _angles(random, sequence)
    wxyz, factor = [random.uniform(-1.0, 1.0) for _ in range(4)], random.choice((-2.5, -1.0, 0.5))
    axis, angle = wxyz[:3], random.uniform(-3.0, 3.0)
    x, y = np.array(wxyz[:3]), np.array([0.3, -0.2, 0.9])
    unit_of = degrees if unit == "degree" else float
    pairs = {
        "euler": [[unit_of(one) for one in some] for some in (angles, _other_angles(random, angles, sequence))],
        "quat": [wxyz, [factor * one for one in wxyz]],
        "axisangle": [[*axis, unit_of(angle)], [*(-3.0 * np.array(axis)).tolist(), unit_of(2.0 * pi - angle)]],
        "xyaxes": [[*x, *y], [*(2.0 * x), *(0.5 * y + 0.7 * x)]],
        "zaxis": [axis, [3.0 * one for one in axis]],
    }
    for attribute, (ours, theirs) in pairs.items():
        changed = list(ours)
        index = random.randrange(len(changed))
        changed[index] += unit_of(1e-6)
        for other, expected in ((theirs, True), (changed, False)):
            seen = [_quaternion(mujoco, attribute, list(map(float, one)), sequence, unit) for one in (ours, other)]
            assert _same_rotation(*seen) is expected, attribute
            texts = [" ".join(repr(float(one)) for one in some) for some in (ours, other)]
            assert means_the_same(f"mujoco/worldbody/site@{attribute}", *texts, said) is expected, attribute


def test_a_segment_is_the_same_from_either_end() -> None:
    """`fromto` of a geom; three numbers are no segment."""
    place = "mujoco/worldbody/body/geom@fromto"
    assert means_the_same(place, "0 0 0 1 2 3", "1 2 3 0 0 0", {})
    assert not means_the_same(place, "0 0 0 1 2 3", "0 0 0 1 2 -3", {})
    assert not means_the_same(place, "0 0 0", "1 2 3", {})


def test_a_pose_has_the_words_of_its_format() -> None:
    """Degrees and quaternions of SDFormat; a position is never a direction."""
    place = "sdf/model/link/pose"
    degrees_said = {f"{place}@degrees": Statement("", "true", read=True)}
    assert means_the_same(place, "1 2 3 0 0 90", "1 2 3 0 0 -270", degrees_said)
    assert not means_the_same(place, "1 2 3 0 0 90", "1 2 3 0 0 -270", {})
    assert means_the_same(place, "1 2 3 0 0 0 1", "1 2 3 0 0 0 -2", {})
    assert not means_the_same(place, "1 2 3 0 0 0", "2 4 6 0 0 0", {})
    assert not means_the_same("robot/joint/origin@xyz", "1 0 0", "2 0 0", {})
    assert means_the_same("robot/joint/axis@xyz", "1 0 0", "2 0 0", {})
    assert not means_the_same("robot/joint/axis@xyz", "1 0 0", "-1 0 0", {})


@pytest.mark.parametrize("area", [1e-6, 1.0, 1e4])
@pytest.mark.parametrize(("share", "same"), [(0.5, True), (2.0, False)])
def test_surfaces_of_meshes_are_compared_by_their_size(share: float, same: bool, area: float) -> None:
    """What rounded vertices change in areas [m^2] and centroids [m] grows with the mesh; an empty one has no area."""
    said, off = {"mesh@area": Statement("", repr(area), read=True)}, share * _RESHAPED
    assert means_the_same("mesh@area", repr(area), repr(area * exp(off)), said) is same
    assert means_the_same("mesh@centroid", "0 0 0", f"0 {off * sqrt(area)!r} 0", said) is same
    assert not means_the_same("mesh@area", "0", repr(off), said)
