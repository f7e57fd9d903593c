"""A URDF as others write them: primitives, a mesh in a package, a mimic, a transmission, parts of no model."""

from pathlib import Path

from stepbot.geometry.mesh import TriMesh

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <material name="steel"><color rgba="0.5 0.5 0.6 1"/></material>
  <link name="world"/>
  <joint name="mount" type="fixed"><parent link="world"/><child link="base"/></joint>
  <link name="base">
    <inertial><mass value="4"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.03"/></inertial>
    <visual><geometry><cylinder radius="0.1" length="0.1"/></geometry><material name="steel"/></visual>
    <collision><geometry><cylinder radius="0.1" length="0.1"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.05" rpy="0.1 0.2 0.3"/>
    <parent link="base"/><child link="upper"/><axis xyz="0 1 1"/>
    <limit lower="-1.5" upper="2" effort="40" velocity="3"/><dynamics damping="0.5" friction="0.1"/>
    <safety_controller k_velocity="10"/>
  </joint>
  <link name="upper">
    <inertial>
      <origin xyz="0.01 0.02 0.15" rpy="0.3 -0.2 0.1"/>
      <mass value="2"/><inertia ixx="0.02" ixy="0.001" ixz="-0.002" iyy="0.021" iyz="0.0005" izz="0.004"/>
    </inertial>
    <visual><geometry><mesh filename="package://arm_description/meshes/upper.stl" scale="0.001 0.001 0.001"/></geometry>
      <material name="red"><color rgba="1 0 0 1"/></material></visual>
    <collision><geometry><box size="0.1 0.1 0.3"/></geometry><origin xyz="0 0 0.15"/></collision>
  </link>
  <joint name="slide" type="prismatic">
    <origin xyz="0 0 0.3"/><parent link="upper"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.1"/>
  </joint>
  <link name="finger">
    <inertial><mass value="0.1"/><inertia ixx="2e-5" ixy="0" ixz="0" iyy="2e-5" iyz="0" izz="2e-5"/></inertial>
    <collision><geometry><sphere radius="0.02"/></geometry></collision>
  </link>
  <joint name="follower" type="prismatic">
    <origin xyz="0 0 0.3"/><parent link="upper"/><child link="thumb"/><axis xyz="-1 0 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.1"/><mimic joint="slide" multiplier="1" offset="0"/>
  </joint>
  <link name="thumb">
    <inertial><mass value="0.1"/><inertia ixx="2e-5" ixy="0" ixz="0" iyy="2e-5" iyz="0" izz="2e-5"/></inertial>
  </link>
  <transmission name="shoulder_motor">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="shoulder"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name="shoulder_motor"><mechanicalReduction>50</mechanicalReduction></actuator>
  </transmission>
</robot>
"""
MILLIMETRES = TriMesh.of(
    [[-50, -50, 0], [50, -50, 0], [0, 60, 0], [0, 0, 300]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
)


def write_arm(folder: Path, text: str = ARM) -> Path:
    """Write the URDF, and its mesh in a package elsewhere; returns the URDF."""
    import trimesh

    meshes = folder / "packages" / "arm_description" / "meshes"
    meshes.mkdir(parents=True)
    trimesh.Trimesh(MILLIMETRES.vertices, MILLIMETRES.faces, process=False).export(meshes / "upper.stl")
    path = folder / "source" / "arm.urdf"
    path.parent.mkdir()
    path.write_text(text, encoding="utf-8")
    return path
