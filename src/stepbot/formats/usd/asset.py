"""``convert --for simready``: a robot in one layer for each concern, by the rules of SimReady's Robot-Body 3.0.0.

The main file refers to ``payloads/base.usda`` (links, frames, visuals, which refer to meshes and materials) and to
``payloads/physics/physics.usda`` (UsdPhysics). What one engine alone reads is in a layer under ``runnables``, which a
variant of the robot's prim loads: armature, passive forces, velocity limits and mimics in the schemas and units of
Newton, PhysX or MuJoCo. https://nvidia.github.io/simready-foundation/ has the rules.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from math import isfinite

from msgspec.structs import replace

from stepbot.robot.gains import actuator_limit
from stepbot.robot.model import Actuator, ActuatorKind, JointKind, Robot

from ..xml import number
from .joints import JOINTS, per_stage_unit, stage_unit
from .meshes import MeshLayer
from .shapes import MATERIALS
from .usda import INDENT, Names, Prim, asset_path, layer, quoted, single, written_by
from .writer import tree

_BASE, _PHYSICS = "payloads/base.usda", "payloads/physics/physics.usda"
_GEOMETRIES, _INSTANCES, _MATERIALS = "geometries.usdc", "instances.usda", "materials.usda"
_EQUALITIES = {JointKind.FIXED: "MjcEqualityWeldAPI", JointKind.BALL: "MjcEqualityConnectAPI"}
"""MuJoCo's schemas of closures; those of other types are UsdPhysics' joints alone."""
_NO_PARAMETERS = (0.0,) * 10
"""Readers take arrays of ten parameters alone, as MuJoCo has them."""


def asset_files(robot: Robot) -> dict[str, bytes]:
    """All layers, by path relative to the asset's folder.

    Args:
        robot: The robot as OpenUSD expresses it.
    """
    meshes, instances = MeshLayer(robot, _GEOMETRIES), MeshLayer(robot, _INSTANCES, "instances")
    top, library = tree(robot, instances)
    scopes = [child for child in top.children if child.name == JOINTS]
    links = replace(top, children=[child for child in top.children if child not in scopes])
    joints = scopes[0].children if scopes else []
    colors, contacts = library.colors(""), library.contacts()

    base = _part(links, _is_look, define=True)
    if colors or contacts:
        refer = [f"prepend references = {asset_path(f'./{_MATERIALS}')}"] if colors else []
        base.add(Prim("Scope", MATERIALS, metadata=refer))
    physics = _part(links, _is_neutral, define=False)
    physics.children += [_part(scope, lambda name: not _is_newton(name), define=True) for scope in scopes]
    if contacts:
        physics.add(_over(MATERIALS, children=contacts))
    engines = {
        "PhysX": _physx(top.name, robot, joints),
        "Newton": _part(top, _is_newton, define=False),
        "MuJoCo": _mujoco(top, robot, joints),
    }

    doc = written_by(robot)
    files = {f"{robot.name}.usda": _interface(top, tuple(engines), doc)}
    files |= {_BASE: layer(base, doc), _PHYSICS: layer(physics, doc)}
    files |= {_runnable(engine): layer(prim, doc) for engine, prim in engines.items()}
    if colors:
        files[f"payloads/{_MATERIALS}"] = layer(Prim("Scope", MATERIALS, children=colors), doc)
    if (content := meshes.content()) is not None:
        files |= {f"payloads/{_INSTANCES}": layer(meshes.instances(instances), doc), f"payloads/{_GEOMETRIES}": content}
    return files


def configurations(name: str, files: Mapping[str, str]) -> bytes:
    """A layer with one robot of several files, which its variant set ``configuration`` selects: the first one at first.

    Args:
        name: Name of the prim; those of the files are their default ones.
        files: Paths relative to the layer, by the names of the variants, which become identifiers; ``default`` is that
            of the robot without a variant.
    """
    identifiers = Names()
    variants = [(quoted(identifiers.of(one or "default")), asset_path(f"./{path}")) for one, path in files.items()]
    selected = f"{INDENT}string configuration = {variants[0][0]}"
    metadata = ['prepend variantSets = "configuration"', "variants = {", selected, "}"]
    options = (f"{INDENT}{one} (prepend references = {path}) {{ }}" for one, path in variants)
    properties = ['variantSet "configuration" = {', *options, "}"]
    return layer(Prim("", Names().of(name), metadata=metadata, properties=properties))


def _interface(top: Prim, engines: tuple[str, ...], doc: str) -> bytes:
    """The main layer: the payloads, and a variant set for each engine, which is off until it is selected."""
    payloads = ", ".join(asset_path(f"./{path}") for path in (_PHYSICS, _BASE))
    sets = ", ".join(map(quoted, engines))
    off = (f'{INDENT}string {engine} = "Disabled"' for engine in engines)
    metadata = [f"prepend payload = [{payloads}]", f"prepend variantSets = [{sets}]", "variants = {", *off, "}"]
    prim = Prim("Xform", top.name, metadata=[*top.metadata, *metadata])
    for engine in engines:
        payload = asset_path(f"./{_runnable(engine)}")
        options = ('"Disabled" { }', f'"Enabled" (prepend payload = {payload}) {{ }}')
        prim.properties += [f"variantSet {quoted(engine)} = {{", *(INDENT + option for option in options), "}"]
    return layer(prim, doc, ["customLayerData = {", *_metadata(f"/{top.name}", engines), "}"])


def _metadata(path: str, engines: tuple[str, ...]) -> Iterator[str]:
    """What SimReady's tools read of the variants without composing the layers."""
    opened = [f"dictionary {name} = {{" for name in ("SimReady_Metadata", "Variants", "Physics")]
    yield from (f"{INDENT * depth}{line}" for depth, line in enumerate(opened, 1))
    for engine in engines:
        entry = {"prim": path, "variantSetName": engine, "activateOption": "Enabled"}
        yield f"{INDENT * 4}dictionary {engine} = {{"
        yield from (f"{INDENT * 5}string {name} = {quoted(value)}" for name, value in entry.items())
        yield f"{INDENT * 4}}}"
    yield from (f"{INDENT * depth}}}" for depth in range(len(opened), 0, -1))


def _runnable(engine: str) -> str:
    return f"runnables/physics/{engine.lower()}.usda"


def _is_newton(name: str) -> bool:
    return name.startswith(("Newton", "newton:"))


def _is_neutral(name: str) -> bool:
    return name.startswith(("Physics", "physics:", "material:binding:physics"))


def _is_look(name: str) -> bool:
    return not (_is_newton(name) or _is_neutral(name))


def _part(prim: Prim, has: Callable[[str], bool], *, define: bool) -> Prim:
    """What a layer has of a prim and of all below it.

    Args:
        prim: The whole.
        has: Whether the layer has a schema or property, by its name.
        define: Whether the layer defines the prims; otherwise it adds to them, and omits those that it adds nothing to.
    """
    children = [_part(child, has, define=define) for child in prim.children]
    schemas = [schema for schema in prim.schemas if has(schema)]
    properties = [one for one in prim.properties if has(one.partition(" = ")[0].rpartition(" ")[2])]
    if define:
        return replace(prim, schemas=schemas, properties=properties, children=children)
    stated = [child for child in children if child.schemas or child.properties or child.children]
    return _over(prim.name, schemas, properties, stated)


def _over(
    name: str, schemas: Iterable[str] = (), properties: Iterable[str] = (), children: Iterable[Prim] = ()
) -> Prim:
    """What a layer adds to a prim of another."""
    return Prim("", name, list(schemas), [], list(properties), list(children), "over")


def _physx(top: str, robot: Robot, prims: list[Prim]) -> Prim:
    """PhysX's layer: https://docs.omniverse.nvidia.com/kit/docs/omni_usd_schema_physics/.

    ``PhysxJointAPI`` is for Isaac Sim up to 5, ``PhysxJointAxisAPI`` for later versions, which lack the former.
    """
    paths = _paths(top, robot, prims)
    over = _over(top)
    if robot.joints:
        over.schemas.append("PhysxArticulationAPI")
        over.set("bool physxArticulation:enabledSelfCollisions", "true")
    scope = over.add(_over(JOINTS))
    for joint, prim in zip(robot.joints, prims, strict=False):  # closures and the joint to the world follow
        if not joint.kind.is_pair:
            continue
        axis = "linear" if joint.kind is JointKind.PRISMATIC else "angular"
        added = scope.add(_over(prim.name, ["PhysxJointAPI", f"PhysxJointAxisAPI:{axis}"]))
        velocity = stage_unit(joint, joint.limit.velocity) if isfinite(joint.limit.velocity) else 0.0
        given = {"armature": joint.dynamics.armature, "maxJointVelocity": velocity}
        friction = dict.fromkeys(("staticFrictionEffort", "dynamicFrictionEffort"), joint.dynamics.friction)
        damping = {"viscousFrictionCoefficient": per_stage_unit(joint, joint.dynamics.damping)}
        for name, value in {**given, **friction, **damping}.items():
            if value:
                added.set(f"float physxJointAxis:{axis}:{name}", single(value))
                if name in given:
                    added.set(f"float physxJoint:{name}", single(value))
        if joint.mimic is not None:  # PhysX's equation: follower + gearing leader + offset = 0, about the joints' axes
            added.schemas.append("PhysxMimicJointAPI:rotX")
            added.set("float physxMimicJoint:rotX:gearing", single(-joint.mimic.multiplier))
            added.set("float physxMimicJoint:rotX:offset", single(-stage_unit(joint, joint.mimic.offset)))
            added.set("rel physxMimicJoint:rotX:referenceJoint", f"<{paths[joint.mimic.joint]}>")
    return over


def _mujoco(top: Prim, robot: Robot, prims: list[Prim]) -> Prim:
    """MuJoCo's layer, in SI units: https://mujoco.readthedocs.io/en/stable/OpenUSD/mjcPhysics.html."""
    paths = _paths(top.name, robot, prims)
    over = _colliders(top) or _over(top.name)
    scope = over.add(_over(JOINTS))
    for joint, prim in zip(robot.joints, prims, strict=False):  # closures and the joint to the world follow
        if joint.kind is JointKind.FIXED:
            continue
        added = scope.add(_over(prim.name, ["MjcJointAPI"]))
        given = {
            "armature": joint.dynamics.armature,
            "damping": joint.dynamics.damping,
            "frictionloss": joint.dynamics.friction,
        }
        for name, value in given.items():
            if value:
                added.set(f"uniform double mjc:{name}", number(value))
        _range(added, "actuatorfrcrange", joint.limit.effort)
        if joint.mimic is not None:
            added.schemas.append("MjcEqualityJointAPI")
            added.set("uniform double mjc:coef0", number(joint.mimic.offset))
            added.set("uniform double mjc:coef1", number(joint.mimic.multiplier))
            added.set("rel mjc:target", f"<{paths[joint.mimic.joint]}>")
    for closure, prim in zip(robot.closures, prims[len(robot.joints) :], strict=False):
        if api := _EQUALITIES.get(closure.kind):
            scope.add(_over(prim.name, [api]))
    if robot.actuators:
        name = Names(child.name for child in top.children).of("actuators")  # a link may have that name
        over.add(Prim("Scope", name, children=[_actuator(actuator, robot, paths) for actuator in robot.actuators]))
    return over


def _paths(top: str, robot: Robot, prims: list[Prim]) -> dict[str, str]:
    """The path of each joint."""
    return {joint.name: f"/{top}/{JOINTS}/{prim.name}" for joint, prim in zip(robot.joints, prims, strict=False)}


def _colliders(prim: Prim) -> Prim | None:
    """What MuJoCo's layer adds to collisions, of which it takes the convex hulls; None without any."""
    children = [added for child in prim.children if (added := _colliders(child))]
    if "PhysicsCollisionAPI" in prim.schemas:
        added = _over(prim.name, ["MjcCollisionAPI"])
        if "PhysicsMeshCollisionAPI" in prim.schemas:
            added.set("uniform token physics:approximation", '"convexHull"')
        return added
    return _over(prim.name, children=children) if children else None


def _actuator(actuator: Actuator, robot: Robot, paths: dict[str, str]) -> Prim:
    """A drive as MuJoCo computes it: force = gain ctrl + bias of position and speed."""
    joint = robot.joint_by_name[actuator.joint]
    prim = Prim("MjcActuator", f"{paths[joint.name].rpartition('/')[2]}_actuator")
    prim.metadata.append(f"displayName = {quoted(actuator.name)}")
    kp, kv = actuator.kp, actuator.kv
    gains = {ActuatorKind.POSITION: (kp, -kp, -kv), ActuatorKind.VELOCITY: (kv, 0.0, -kv)}
    if actuator.kind in gains:
        gain, *bias = gains[actuator.kind]
        for name, parameters in (("biasPrm", (0.0, *bias)), ("gainPrm", (gain,))):
            padded = (*parameters, *_NO_PARAMETERS)[: len(_NO_PARAMETERS)]
            prim.set(f"uniform double[] mjc:{name}", f"[{', '.join(map(number, padded))}]")
        prim.set("uniform token mjc:biasType", '"affine"')
    _range(prim, "forceRange", actuator_limit(actuator, joint).effort)
    prim.set("rel mjc:target", f"<{paths[joint.name]}>")
    return prim


def _range(prim: Prim, name: str, bound: float) -> None:
    """A symmetric range of forces [N, N m], if there is one."""
    if isfinite(bound):
        prim.set(f"uniform double mjc:{name}:min", number(-bound))
        prim.set(f"uniform double mjc:{name}:max", number(bound))
