"""Steps per second of MJCF files: what differs beside shapes is named and made equal, and other robots are rejected."""

from pathlib import Path

import pytest

from benchmarks.command import main
from benchmarks.stepping import NotOneRobot, compare_steps, made_equal

pytestmark = pytest.mark.mujoco

ARM = """<mujoco>
  <option timestep="{step}"/>
  <worldbody><body name="arm"><joint name="turn" damping="{damping}"/><geom type="capsule" size="0.02 {length}"/>
    <geom type="sphere" size="0.03" contype="0" conaffinity="0"/></body></worldbody>
  <actuator><position name="drive" joint="turn" kp="{kp}"/></actuator>
</mujoco>"""


def arm(
    folder: Path, name: str, *, step: float = 0.002, damping: float = 0.1, kp: float = 5.0, length: float = 0.2
) -> Path:
    """An arm of one joint."""
    path = folder / f"{name}.xml"
    path.write_text(ARM.format(step=step, damping=damping, kp=kp, length=length), encoding="utf-8")
    return path


def test_options_gains_and_damping_are_made_equal(tmp_path: Path) -> None:
    """Afterwards nothing but shapes differs; a second comparison finds no difference."""
    mujoco = pytest.importorskip("mujoco")
    one = mujoco.MjModel.from_xml_path(str(arm(tmp_path, "one")))
    changed = {"step": 0.001, "damping": 0.2, "kp": 7.0, "length": 0.3}
    other = mujoco.MjModel.from_xml_path(str(arm(tmp_path, "other", **changed)))
    assert made_equal(other, one) == ["timestep", "actuator_gainprm", "actuator_biasprm", "dof_damping"]
    assert made_equal(other, one) == []
    assert (other.opt.timestep, float(other.dof_damping[0])) == (0.002, 0.1)
    assert float(other.geom_size[0][1]) == 0.3


def test_lines_state_shapes_ratios_and_differences(tmp_path: Path) -> None:
    """Both comparisons are made where the files differ in more than shapes, one where they do not."""
    files = {"one": arm(tmp_path, "one"), "same": arm(tmp_path, "same", length=0.3)}
    lines = compare_steps(files, rounds=2, steps=60)
    assert lines[:2] == [f"{name}: 1 collision shapes, 0 vertices, 0 excluded pairs of bodies" for name in files]
    (line,) = lines[2:]
    assert line.startswith("as written: one ")
    assert line.endswith("contacts 0.00 and 0.00")
    lines = compare_steps({**files, "stiff": arm(tmp_path, "stiff", kp=9.0)}, rounds=2, steps=60)
    assert lines[5] == "differ in actuator_gainprm, actuator_biasprm"
    assert [line.partition(":")[0] for line in lines[3:]] == [
        *("as written", "as written", lines[5], "these made equal", "these made equal")
    ]


def test_another_robot_is_rejected(tmp_path: Path) -> None:
    """Files with other joints or actuators are not compared, and one file alone has nothing to be compared with."""
    plain = tmp_path / "plain.xml"
    plain.write_text("<mujoco><worldbody><body><geom size='1'/></body></worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(NotOneRobot, match="different joints or actuators"):
        compare_steps({"one": arm(tmp_path, "one"), "plain": plain}, rounds=1, steps=1)
    with pytest.raises(SystemExit, match="nothing to compare with"):
        main(["steps", str(plain)])
