"""Sidecars for tests."""

FULL = """\
version: 1
robot: follower
step: cad/follower.step
base: floating
root: {link: base, frame: {axis_of: "XL-430:1/IDLER", offset: {xyz: [0, 0, -40 mm]}}}
materials:
  pla: {density: 1240 kg/m^3, color: "#e0e0e0"}
defaults: {material: pla, density: 1.2 g/cm^3, color: [0.5, 0.5, 0.5]}
step_density: ignore
mass: mesh
mesh: {tolerance: 0.1 %, angle: 10 deg}
parts:
  "**/M3x8*": {ignore: true}
  "**/XL-430*": {mass: 57.2 g}
  "**/Cover": {density: 1.04 g/cm^3, material: pla, color: "#303030", visual: false, collision: none}
links:
  base: {parts: ["Simple Base", "XL-430:1"], rest: true, visual: true, collision: {merge: hull}}
  shoulder: {parts: ["rotation connector"], collision: hull, mesh: {tolerance: 0.1 mm}}
  gripper:
    parts: [gripper]
    inertial: {mass: 0.11 kg, com: [0, 0, 0.02], inertia: {ixx: 1e-5, iyy: 1e-5, izz: 2e-5, ixy: -1e-7}}
    collision:
      - {type: box, size: [10 mm, 20 mm, 30 mm], origin: {xyz: [0, 0, 1 cm], rpy: [0, 90 deg, 0]}}
      - {type: sphere, radius: 5 mm}
  jaw: {parts: ["moving side"]}
joint_defaults: {"*": {limits: {effort: 1.5 N*m, velocity: 61 rpm}, dynamics: {damping: 0.1}}}
joints:
  pan:
    type: revolute
    parent: base
    child: shoulder
    limits: {lower: -150 deg, upper: 150 deg}
    zero: 30 deg
  lift:
    type: revolute
    parent: shoulder
    child: gripper
    origin: {mate: [a, b], radius: 8 mm, near: [0, 0, 100 mm]}
    axis: -z
    limits: {lower: -inf, upper: 1}
  grip:
    type: revolute
    parent: gripper
    child: jaw
    origin: {xyz: [0, 0, 1], rpy: [0, 0, 90 deg], relative_to: gripper}
    axis: [0, 1, 1]
    limits: {lower: -1, upper: 1}
    dynamics: {friction: 0.01, stiffness: 1 N*m/rad, spring_reference: 10 deg, armature: 20 g*cm^2}
    mimic: {joint: lift, multiplier: -1, offset: 0}
closures:
  pin: {type: revolute, link_a: base, link_b: jaw, origin: auto, axis: y}
frames:
  tool0: {link: jaw, origin: {center: "moving side"}}
actuators:
  motor: {joint: pan, kind: position, kp: 100, kv: 5, gear: 2}
sensors:
  imu: {type: imu, link: base}
"""
"""A sidecar with every key; its mimic contradicts its limits, which is a warning."""
