"""A robot with every kind of actuator and sensor, each at a pose that differs from the default."""

import math

from stepbot.geometry.spatial import IDENTITY
from stepbot.robot.model import Actuator, ActuatorKind, Frame, Joint, JointDynamics, JointKind, Limit, Robot
from stepbot.robot.sensors import Sensor, SensorKind, View
from tests.workshop import ORANGE, Workshop, at


def equipped() -> Robot:
    """An arm on a plate: a geared servo, a wheel drive, a bare motor; an IMU, two cells, encoders, eyes, a bumper."""
    shop = Workshop()
    base = shop.link("base", [((0.3, 0.2, 0.04), at(z=0.02, rpy=(0, 0, 0.1)))])
    arm = shop.link("arm", [((0.3, 0.03, 0.04), at(x=0.15, rpy=(0.1, 0, 0)))], rgba=ORANGE)
    tool = shop.link("tool", [((0.05, 0.04, 0.03), at(x=0.03, rpy=(0.2, 0.1, 0)))])
    wheel = shop.link("wheel", [((0.1, 0.02, 0.1), at(y=0.02))])
    eye = shop.link("eye", [((0.02, 0.03, 0.025), at(x=0.03))])
    slide = shop.link("slide", [((0.06, 0.03, 0.02), at(z=0.02))])
    joints = (
        Joint(
            "shoulder",
            JointKind.REVOLUTE,
            "base",
            "arm",
            at(0, 0, 0.06, (0.1, -0.2, 1 / 3)),
            limit=Limit(-math.pi / 3, 2.0, velocity=3.0, effort=12.0),
            dynamics=JointDynamics(damping=0.05, friction=1 / 70, stiffness=0.7, spring_reference=0.2, armature=0.003),
        ),
        Joint("flange", JointKind.FIXED, "arm", "tool", at(1 / 3, 0, 0, (0.4, 0, 0.1))),
        Joint("axle", JointKind.CONTINUOUS, "base", "wheel", at(0.1, 0.12, 0), (0.0, 1.0, 0.0)),
        Joint("neck", JointKind.CONTINUOUS, "base", "eye", at(-0.1, 0, 0.1, (0, 0, 0.3))),
        Joint(
            "rail",
            JointKind.PRISMATIC,
            "base",
            "slide",
            at(-0.05, -0.12, 0.02),
            (0.6, 0.0, 0.8),
            limit=Limit(-0.1, 0.2),
        ),
    )
    sensors = (
        Sensor("imu", SensorKind.IMU, "base", at(1 / 30, 0.02, 0.05, (0.3, 0.2, -0.1)), rate=200.0),
        Sensor("wrist_cell", SensorKind.FORCE_TORQUE, "tool", at(rpy=(0, 0, 0.5)), joint="flange", rate=1000.0),
        Sensor("shoulder_cell", SensorKind.FORCE_TORQUE, "arm", IDENTITY, joint="shoulder"),
        Sensor("shoulder_encoder", SensorKind.JOINT, "arm", joint="shoulder", rate=100.0),
        Sensor("neck_encoder", SensorKind.JOINT, "eye", joint="neck"),
        Sensor(
            "camera", SensorKind.CAMERA, "eye", at(0.05, 0, 0.01, (0.1, 0.2, 0)), view=View(1.2, 640, 360, 0.2, 90.0)
        ),
        Sensor("tool_camera", SensorKind.CAMERA, "tool", at(z=0.03), rate=30.0, view=View(0.9, 324, 244, 0.05, 3.0)),
        Sensor("lidar", SensorKind.LIDAR, "base", at(0.1, 0, 0.06, (0, 0.02, 0)), "", 10.0, View(4.0, 9, 1, 0.1, 12.0)),
        Sensor("beam", SensorKind.LIDAR, "slide", IDENTITY, view=View(0.0, 1, 1)),
        Sensor("bumper", SensorKind.CONTACT, "tool", rate=50.0),
    )
    return Robot(
        "equipped",
        (base, arm, tool, wheel, eye, slide),
        joints,
        frames=(Frame("tcp", "tool", at(0.06, 0, 0, (0, math.pi / 2, 0))),),
        actuators=(
            Actuator("servo", "shoulder", ActuatorKind.POSITION, kp=0.05, kv=0.002, gear=-50.0),
            Actuator("boost", "shoulder", ActuatorKind.MOTOR, gear=20.0, limit=Limit(effort=4.0)),
            Actuator("traction", "axle", ActuatorKind.VELOCITY, kv=0.3, limit=Limit(velocity=20.0, effort=1.5)),
            Actuator("feed", "rail", ActuatorKind.POSITION, kp=800.0, limit=Limit(lower=-0.05)),
        ),
        meshes=shop.sorted_meshes(),
        source="equipped.step",
        sensors=sensors,
    )
