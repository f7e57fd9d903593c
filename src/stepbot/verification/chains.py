"""The joint between two links as one file represents it: a single joint, or several with massless links in between.

URDF represents a ball joint by three revolute joints with two massless links in between; MJCF by one joint, and a
universal joint by two in one body. The connection of two links that both files have is an *edge* of either file, which
can be compared as a *chain* of single-axis joints.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink
from stepbot.geometry.spatial import Array, Pose, cross_matrix, rotation_angle, vector3
from stepbot.robot.joint_types import HINGES, PAIRS, kinds_with

from .naming import Naming, steps_of

_SMALL = 1e-12
"""Angle [rad] below which a motion is a pure translation."""


def twist_of(motion: Pose) -> Array:
    """The twist (6,) that generates a motion in one second; rotations are below half a turn."""
    R = motion.R
    angle = rotation_angle(R)
    if angle < _SMALL:
        return np.concatenate([np.zeros(3), motion.p])
    twice_sine = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    w = twice_sine * angle / float(np.linalg.norm(twice_sine))
    K = cross_matrix(w)
    V = np.eye(3) + K * ((1.0 - np.cos(angle)) / angle**2) + K @ K * ((angle - np.sin(angle)) / angle**3)
    return np.concatenate([w, np.linalg.solve(V, motion.p)])


def pitch_of(twist: Array) -> float:
    """Advance [m/rad] of a rotating twist."""
    w, v = twist[:3], twist[3:]
    return float(w @ v) / float(w @ w)


def foot(twist: Array) -> Array:
    """The point (3,) [m] on a rotating twist's axis that is nearest to the origin."""
    w, v = twist[:3], twist[3:]
    return np.asarray(np.cross(w, v)) / float(w @ w)


def common_point(twists: Array) -> tuple[Array, float]:
    """The point (3,) [m] nearest to the axes of twists (n, 6), and their largest velocity [m/s] at it."""
    A = np.vstack([-cross_matrix(twist[:3]) for twist in twists])
    b = np.concatenate([twist[3:] for twist in twists])
    p: Array = np.linalg.lstsq(A, b, rcond=None)[0]
    return p, float(np.abs(A @ p - b).max())


def direction(twist: Array) -> tuple[float, float, float]:
    """Unit direction of a twist's axis; of its translation if it does not rotate."""
    w = twist[:3] if np.linalg.norm(twist[:3]) > _SMALL else twist[3:]
    return vector3(w / np.linalg.norm(w))


_SEVERAL = frozenset(kinds_with(is_pair=False)) - {"fixed"}
"""Types of joints that formats represent differently."""
PARALLEL = 1e-9
"""Largest sine of the angle between directions that count as parallel."""


class Edge(Struct, frozen=True):
    """The connection of two links."""

    parent: str
    child: str
    joints: tuple[ObservedJoint, ...]
    """From the parent on."""
    between: tuple[str, ...]
    """Links that exist only because of the joints."""

    @property
    def is_plain(self) -> bool:
        """Whether all formats represent it in the same way."""
        return len(self.joints) == 1 and self.joints[0].kind not in _SEVERAL


class Step(Struct, frozen=True, eq=False):
    """One joint of a chain."""

    kind: str
    """``turn``, ``slide``, ``screw`` or ``ball``."""
    names: tuple[str, ...]
    """Its coordinates: one, or three of a ball."""
    twists: Array
    """Twist of each coordinate at unit speed, in the frame of the chain's parent, at zero; shape (n, 6)."""
    joint: ObservedJoint
    named: bool = True
    followers: Mapping[str, float] = field(default_factory=dict)
    """Coordinates that follow, and their multipliers."""


class Chain(Struct, frozen=True, eq=False):
    """The connection of two links, one degree of freedom per step."""

    edge: Edge
    X_PC: Pose
    """Pose of the child in the parent with all joints at 0."""
    steps: tuple[Step, ...]


def is_bare(link: ObservedLink) -> bool:
    """Whether a link is only a frame."""
    return not (link.mass or link.has_visuals or link.has_collisions)


def unlike_edges(a: Observation, b: Observation) -> list[tuple[Edge, Edge]]:
    """The edges between the same two links that at least one side represents in a way that other formats do not."""
    ours, theirs = _edges(a, {link.name for link in b.links}), _edges(b, {link.name for link in a.links})
    pairs = [(edge, theirs[child]) for child, edge in ours.items() if child in theirs]
    return [(x, y) for x, y in pairs if x.parent == y.parent and not (x.is_plain and y.is_plain)]


def _edges(observation: Observation, others: set[str]) -> dict[str, Edge]:
    """For each link with a parent that does not exist only because of joints, the edge above it."""
    above: dict[str, list[ObservedJoint]] = {}
    for joint in observation.joints:
        above.setdefault(joint.child, []).append(joint)
    bare = {link.name for link in observation.links if is_bare(link) and not np.any(link.inertia or 0.0)} - others
    between = {link for link in bare if link in above and len(_below(observation, link)) == 1}
    edges = {}
    for child in (child for child in above if child not in between):
        joints, links, parent = list(above[child]), list[str](), above[child][0].parent
        while parent in between and parent not in links:
            links.insert(0, parent)
            joints = above[parent] + joints
            parent = above[parent][0].parent
        edges[child] = Edge(parent, child, tuple(joints), tuple(links))
    return edges


def _below(observation: Observation, link: str) -> set[str]:
    return {joint.child for joint in observation.joints if joint.parent == link}


def coordinates(edge: Edge, naming: Naming) -> list[str]:
    """Names of the coordinates of an edge, from the parent on."""
    return [name for _, names, _, _ in _dofs(edge, naming) for name in names]


def _dofs(edge: Edge, naming: Naming) -> Iterator[tuple[str, tuple[str, ...], ObservedJoint, bool]]:
    """Kind, coordinates and observed joint of each joint of an edge, and whether it is named.

    Joints without coordinates in the engines are left out; see :func:`is_known`.
    """
    for joint in (step for whole in edge.joints for step in steps_of(whole)):
        if joint.kind in HINGES:
            yield "turn", (joint.name,), joint, True
        elif joint.kind in ("prismatic", "screw"):
            yield {"prismatic": "slide"}.get(joint.kind, joint.kind), (joint.name,), joint, True
        elif joint.kind == "ball" and joint.name in naming.balls:
            yield "ball", naming.balls[joint.name], joint, True
        elif joint.kind == "universal" and joint.name in naming.universals:
            for name in naming.universals[joint.name]:
                yield "turn", (name,), replace(joint, name=name, kind="revolute", axis2=None), False


def is_known(edge: Edge, naming: Naming) -> bool:
    """Whether every joint of an edge has coordinates in the engines."""
    moving = [step for joint in edge.joints for step in steps_of(joint) if step.kind != "fixed"]
    single = {*PAIRS, "screw"}
    several = {*naming.balls, *naming.universals}
    return all(step.name and (step.kind in single or step.name in several) for step in moving)


def chain(edge: Edge, naming: Naming, poses: Mapping[str, Pose], X_PC: Pose) -> Chain:
    """The chain of an edge.

    Args:
        naming: The coordinates of its file.
        poses: X_PC with each coordinate at 1 and all others at 0.
        X_PC: With all coordinates at 0.
    """
    back = X_PC.inverse()
    steps = []
    for kind, names, joint, named in _dofs(edge, naming):
        twists = np.array([twist_of(poses[name] @ back) for name in names])
        steps.append(Step(kind, names, twists, joint, named))
    return Chain(edge, X_PC, tuple(_with_screws(_slides_first(steps))))


def _slides_first(steps: Sequence[Step]) -> list[Step]:
    """Revolute joints about the direction of an adjacent prismatic joint may be swapped with it."""
    ordered = list(steps)
    for _ in ordered:
        for i in range(len(ordered) - 1):
            if (ordered[i].kind, ordered[i + 1].kind) == ("turn", "slide") and _coaxial(*ordered[i : i + 2]):
                ordered[i : i + 2] = ordered[i + 1], ordered[i]
    return ordered


def _coaxial(a: Step, b: Step) -> bool:
    across = np.cross(direction(a.twists[0]), direction(b.twists[0]))
    return float(np.linalg.norm(across)) < PARALLEL


def _with_screws(steps: Sequence[Step]) -> Iterator[Step]:
    """A prismatic joint that follows the adjacent revolute joint, about the same axis, forms a screw with it."""
    waiting: Step | None = None
    for step in steps:
        mimic = waiting.joint.mimic if waiting is not None and waiting.kind == "slide" else None
        if waiting is None or step.kind != "turn" or mimic is None or mimic.offset or mimic.joint != step.names[0]:
            follows = False
        else:
            follows = _coaxial(waiting, step)
        if waiting is not None and not follows:
            yield waiting
        waiting = _screw(waiting, step) if waiting is not None and follows else step
    if waiting is not None:
        yield waiting


def _screw(slide: Step, turn: Step) -> Step:
    """One joint for a prismatic joint that follows a revolute one, with the passive forces and limits of both."""
    mimic = slide.joint.mimic
    assert mimic is not None
    m = mimic.multiplier
    twists = turn.twists + m * slide.twists
    return Step("screw", turn.names, twists, _both(turn.joint, slide.joint, m), True, {slide.names[0]: m})


def _both(turn: ObservedJoint, slide: ObservedJoint, m: float) -> ObservedJoint:
    merged = turn
    if turn.limit is not None and slide.limit is not None and m:
        ends = sorted((slide.limit.lower / m, slide.limit.upper / m))
        lower, upper = max(turn.limit.lower, ends[0]), min(turn.limit.upper, ends[1])
        velocity = min(turn.limit.velocity, slide.limit.velocity / abs(m))
        merged = replace(merged, limit=replace(turn.limit, lower=lower, upper=upper, velocity=velocity))
    if turn.dynamics is not None and slide.dynamics is not None:
        a, b = turn.dynamics, slide.dynamics
        stiffness = a.stiffness + m * m * b.stiffness
        reference = a.stiffness * a.spring_reference + m * b.stiffness * b.spring_reference
        dynamics = replace(
            a,
            damping=a.damping + m * m * b.damping,
            friction=a.friction + abs(m) * b.friction,
            stiffness=stiffness,
            spring_reference=reference / stiffness if b.stiffness else a.spring_reference,
            armature=a.armature + m * m * b.armature,
        )
        merged = replace(merged, dynamics=dynamics)
    return merged
