"""Small MJCF models whose motion has a closed form."""

from pathlib import Path

UPPER, FORE, HEIGHT = 0.4, 0.3, 0.2
"""Lengths of the planar arm's links, and height of its plane [m]."""
SPEED = 2.0
"""Velocity limit [rad/s] of its joints."""

ARM = f"""
<mujoco model="arm">
  <compiler angle="radian"/>
  <option timestep="0.002" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="upper" pos="0 0 {HEIGHT}">
      <joint name="shoulder" axis="0 0 1" range="-1.5 2" limited="true"/>
      <geom type="capsule" size="0.02" fromto="0.05 0 0 {UPPER - 0.05} 0 0" mass="1"/>
      <body name="fore" pos="{UPPER} 0 0">
        <joint name="elbow" axis="0 0 1" range="-2 2" limited="true"/>
        <geom type="capsule" size="0.02" fromto="0.05 0 0 {FORE - 0.02} 0 0" mass="0.5"/>
        <site name="tool" pos="{FORE} 0 0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="shoulder_drive" joint="shoulder" kp="200" kv="10" ctrlrange="-1.5 2"/>
    <position name="elbow_drive" joint="elbow" kp="200" kv="10" ctrlrange="-2 2"/>
  </actuator>
  <sensor>
    <jointpos name="shoulder_encoder" joint="shoulder"/>
    <force name="wrist" site="tool"/>
  </sensor>
  <custom>
    <numeric name="shoulder::velocity" data="{SPEED}"/>
    <numeric name="elbow::velocity" data="{SPEED}"/>
  </custom>
  <keyframe><key name="home" qpos="0.3 -0.5" ctrl="0.3 -0.5"/></keyframe>
</mujoco>
"""
HOME = (0.3, -0.5)
"""Its keyframe [rad]."""

BOX = """
<mujoco model="box">
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="trunk" pos="0 0 0.1">
      <freejoint/>
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <body name="head" pos="0 0 0.1">
        <joint name="neck" axis="0 0 1"/>
        <geom type="sphere" size="0.03" pos="0 0 0.04" mass="0.1"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="neck_drive" joint="neck" ctrlrange="-0.01 0.01"/></actuator>
</mujoco>
"""
"""A box of 0.2 m that stands on the floor, with a head on an unlimited joint."""


def written(folder: Path, text: str, name: str = "robot.xml") -> Path:
    """The path of a file with this text."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
