"""OpenUSD with UsdPhysics: https://openusd.org/release/api/usd_physics_page_front.html.

A text file, and a binary one for the meshes, written without USD's own library (decisions 0029 and 0037): links below
the robot's prim, side by side, in the drawn pose; joints and materials in scopes of their own.
"""

from stepbot.geometry.inertia import principal_axes
from stepbot.geometry.spatial import Pose
from stepbot.robot.bounding_boxes import floor_height, standing_height
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.kinematics import initial_configuration, link_poses, without_contacts
from stepbot.robot.model import Base, Frame, Link, Robot

from ..features import USUAL, Feature, altered, deferred, exact, lowered, reported
from ..format import Companion
from . import FORMAT
from .joints import JOINTS, joints, mark_link, mark_robot, mark_site, marked_joints
from .meshes import MeshLayer
from .shapes import MATERIALS, Library, place
from .usda import Names, Prim, asset_path, layer, named, single, singles, written_by

_SENSORS = reported("sensors are omitted")
EXPRESSES = {
    **USUAL,
    Feature.FIXED_BASE: exact("`PhysicsFixedJoint` to the world"),
    Feature.FLOATING_BASE: exact("no joint to the world; standing on z = 0"),
    Feature.INERTIA: exact("`PhysicsMassAPI` with principal moments and axes, in single precision"),
    Feature.MASSLESS_BODY: exact("as any link without mass"),
    Feature.MESH: exact("`Mesh` in `meshes/<robot>.usdc`, once for all links; visuals are instances"),
    Feature.STL_VISUAL: exact("in `meshes/<robot>.usdc`"),
    Feature.DAE_VISUAL: exact("in `meshes/<robot>.usdc`"),
    Feature.GLB_VISUAL: exact("in `meshes/<robot>.usdc`"),
    Feature.STL_COLLISION: exact("in `meshes/<robot>.usdc`"),
    Feature.OTHER_COLLISION: exact("in `meshes/<robot>.usdc`"),
    Feature.SHAPE: exact("`Cube` with a scale, `Cylinder`, `Sphere`"),
    Feature.CAPSULE: exact("`Capsule`"),
    Feature.FLAT_COLLISION: reported("simulators cannot build the convex hull of a flat collision mesh; omitted"),
    Feature.CONCAVE_COLLISION: lowered("the simulator decomposes these collision meshes into convex pieces"),
    Feature.COLOR: exact("a `UsdPreviewSurface` for each colour"),
    Feature.NEIGHBOURS: exact("joints disable it between their bodies"),
    Feature.EXCLUDED_CONTACT: exact("`PhysicsFilteredPairsAPI`"),
    Feature.SURFACE: exact("`PhysicsMaterialAPI` bound to the collision; of two shapes PhysX takes the average"),
    Feature.BOUNCE: exact("`restitution` of `PhysicsMaterialAPI`"),
    Feature.DEAD_BOUNCE: exact("as any restitution"),
    Feature.MIXED_SURFACE: exact("a material for each collision"),
    Feature.FIXED: exact("`PhysicsFixedJoint`"),
    Feature.REVOLUTE: exact("`PhysicsRevoluteJoint` with limits"),
    Feature.CONTINUOUS: exact("`PhysicsRevoluteJoint`"),
    Feature.PRISMATIC: exact("`PhysicsPrismaticJoint`"),
    Feature.BALL: exact("`PhysicsSphericalJoint`"),
    Feature.SCREW: altered("a screw joint is written as a revolute joint and a prismatic one that follows it"),
    Feature.FAR_LIMIT: exact("as any limit"),
    Feature.PASSIVE_LIMIT: exact("as any limit"),
    Feature.OPEN_POSITION: exact("no attribute"),
    Feature.OPEN_EFFORT: exact("no attribute"),
    Feature.EFFORT: exact("`maxForce` of the joint's drive"),
    Feature.VELOCITY: exact("`velocityLimit` of Newton's schema"),
    Feature.FRICTION: exact("`damping`, `friction` of Newton's schema"),
    Feature.SPRING: reported("springs are omitted"),
    Feature.ARMATURE: exact("`armature` of Newton's schema"),
    Feature.STIFF_DAMPING: exact("as any damping"),
    Feature.MIMIC: exact("`NewtonMimicAPI`"),
    Feature.CLOSURE: exact("a joint that is excluded from the articulation"),
    Feature.SLIDING_CLOSURE: exact("a joint that is excluded from the articulation"),
    Feature.STUCK_CLOSURE: exact("a joint that is excluded from the articulation"),
    Feature.FOLLOWER: exact("held by the closure"),
    Feature.LOOP_ZERO: exact("links in the drawn pose"),
    Feature.INITIAL_POSE: exact("links in the drawn pose, which does not tell full turns apart"),
    Feature.FRAME: exact("`Xform` in its link"),
    Feature.ACTUATOR: exact("`PhysicsDriveAPI`, with the name as `customData`"),
    Feature.SECOND_ACTUATOR: reported("a joint has one drive; its further actuators are omitted"),
    Feature.UNLIMITED_ACTUATOR: exact("no attribute"),
    Feature.JOINT_SENSOR: _SENSORS,
    Feature.IMU: _SENSORS,
    Feature.FORCE_TORQUE: _SENSORS,
    Feature.OFF_JOINT: _SENSORS,
    Feature.CAMERA: _SENSORS,
    Feature.OPTICAL: exact("sensors are omitted"),
    Feature.LIDAR: _SENSORS,
    Feature.CONTACT: _SENSORS,
    Feature.SENSOR_PLACE: _SENSORS,
    Feature.SENSOR_RATE: _SENSORS,
    Feature.ENCODER_RATE: _SENSORS,
    Feature.CAMERA_EXTRAS: _SENSORS,
    Feature.LIDAR_NEAREST: _SENSORS,
    Feature.OPEN_VIEW: _SENSORS,
    Feature.TIMESTEP: deferred("settings of the physics engine"),
    Feature.SOLVER: deferred("settings of the physics engine"),
    Feature.JOINT_NAME: exact("joints have a scope of their own, and any name as `displayName`"),
    Feature.FRAME_NAME: exact("frames have scopes of their own, and any name as `displayName`"),
    Feature.RESERVED_NAME: exact("any name as `displayName`"),
}

_SCOPES = (JOINTS, MATERIALS)
"""Scopes beside the links."""


def reserves(_name: str) -> bool:
    """No name is reserved: prims have identifiers of their own."""
    return False


def render(robot: Robot) -> bytes:
    """The text of a lowered robot."""
    top, library = tree(robot, MeshLayer(robot))
    if materials := library.colors(f"/{top.name}") + library.contacts():
        top.add(Prim("Scope", MATERIALS, children=materials))
    return layer(top, written_by(robot))


def tree(robot: Robot, meshes: MeshLayer) -> tuple[Prim, Library]:
    """The robot's prim with its links and joints, and the materials that they refer to."""
    top = named("Xform", robot.name, Names())
    path = f"/{top.name}"
    names, library = Names(_SCOPES), Library(robot, path, meshes)
    identifiers = {link.name: names.of(link.name) for link in robot.links}
    paths = {name: f"{path}/{identifier}" for name, identifier in identifiers.items()}
    if robot.joints:
        top.schemas += ["PhysicsArticulationRootAPI", "NewtonArticulationRootAPI"]
        top.set("bool newton:selfCollisionEnabled", "true")
    top.metadata.append('kind = "component"')
    drawn = initial_configuration(robot)
    X_RL, standing = link_poses(robot, drawn), Pose.of(position=(0.0, 0.0, standing_height(robot, drawn)))
    filtered = _filtered(robot)
    for link in robot.links:
        prim = top.add(named("Xform", link.name, names, identifiers[link.name]))
        mark_link(prim, link.name)
        _body(prim, link)
        if others := filtered.get(link.name):
            prim.schemas.append("PhysicsFilteredPairsAPI")
            prim.set("rel physics:filteredPairs", f"[{', '.join(f'<{paths[other]}>' for other in others)}]")
        place(prim, standing @ X_RL[link.name])
        _content(prim, link, robot, library)
    joined = []
    if robot.joints or robot.base is Base.FIXED:
        joined = marked_joints(top.add(joints(robot, path, paths)))
    mark_robot(top, robot, list(paths.values()), [f"{path}/{JOINTS}/{name}" for name in joined])
    return top, library


def companions(robot: Robot) -> tuple[Companion, ...]:
    """The file of the meshes, if there are any."""
    meshes = MeshLayer(robot)
    content = meshes.content()
    return () if content is None else (Companion(meshes.path, "", robot, content),)


def scenes(robot: Robot) -> dict[str, bytes]:
    """A scene with gravity, floor and light, which refers to the robot."""
    return {f"{robot.name}{FORMAT.scene}": scene(robot, f"{robot.name}{FORMAT.suffix}")}


def _body(prim: Prim, link: Link) -> None:
    body = link.mass_properties
    moments, axes = principal_axes(body.inertia)
    prim.schemas += ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    prim.set("float physics:mass", single(body.mass))
    prim.set("point3f physics:centerOfMass", singles(body.com))
    prim.set("float3 physics:diagonalInertia", singles(moments))
    prim.set("quatf physics:principalAxes", singles(Pose(axes).quaternion))


def _filtered(robot: Robot) -> dict[str, list[str]]:
    """For each link, those later in the file whose contacts with it are excluded, unless a joint does."""
    held = {frozenset((joint.parent, joint.child)) for joint in robot.joints}
    held |= {frozenset((closure.link_a, closure.link_b)) for closure in robot.closures}
    position = {link.name: number for number, link in enumerate(robot.links) if link.collisions}
    filtered: dict[str, list[str]] = {}
    for pair in without_contacts(robot) - held:
        if pair <= position.keys():
            first, later = sorted(pair, key=position.__getitem__)
            filtered.setdefault(first, []).append(later)
    return {first: sorted(later, key=position.__getitem__) for first, later in filtered.items()}


def _content(prim: Prim, link: Link, robot: Robot, library: Library) -> None:
    """Visuals, collisions and frames of a link."""
    visuals, collisions, frames = Names(), Names(), Names()
    groups = {
        "visuals": [library.visual(visual, visuals) for visual in link.visuals],
        "collisions": [library.collision(collision, collisions) for collision in link.collisions],
        "frames": [_frame(frame, frames) for frame in robot.frames if frame.link == link.name],
    }
    for name, prims in groups.items():
        if prims:
            prim.add(Prim("Scope", name, children=prims))


def _frame(frame: Frame, names: Names) -> Prim:
    prim = named("Xform", frame.name, names)
    mark_site(prim)
    place(prim, frame.X_LF)
    return prim


_SUN, _SKY = 2000.0, 300.0
"""Intensities of the lights [nit]: a sunny workshop."""


def scene(robot: Robot, main: str) -> bytes:
    """The scene for a robot in the file ``main``, in the same folder."""
    world = Prim("Xform", "World", metadata=['kind = "assembly"'])  # the robot is a component, a model of its own
    physics = world.add(Prim("PhysicsScene", "physics"))
    physics.set("vector3f physics:gravityDirection", "(0, 0, -1)")
    physics.set("float physics:gravityMagnitude", single(-GRAVITY[2]))
    world.add(_floor(floor_height(robot)))
    sun = world.add(Prim("DistantLight", "sun"))
    sun.set("float inputs:intensity", single(_SUN))
    sky = world.add(Prim("DomeLight", "sky"))
    sky.set("float inputs:intensity", single(_SKY))
    names = Names(child.name for child in world.children)
    world.add(Prim("", names.of(robot.name), metadata=[f"prepend references = {asset_path(f'./{main}')}"]))
    return layer(world)


def _floor(height: float) -> Prim:
    floor = Prim("Plane", "floor", schemas=["PhysicsCollisionAPI"])
    floor.set("uniform token axis", '"Z"')
    floor.set("double length", "100")
    floor.set("double width", "100")
    floor.set("float3[] extent", f"[{singles((-50.0, -50.0, 0.0))}, {singles((50.0, 50.0, 0.0))}]")
    if height:
        floor.set("double3 xformOp:translate", f"(0, 0, {height!r})")
        floor.set("uniform token[] xformOpOrder", '["xformOp:translate"]')
    return floor
