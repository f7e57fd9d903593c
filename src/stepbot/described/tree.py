"""The joints of a description as a tree from one root, each joint above one link and at its frame.

A joint beside the origin of its link gets a link without shape in between, and so does each of several joints in one
body, unless together they are one multi-dof joint of the model.
"""

from collections.abc import Mapping, Sequence, Set
from math import inf, isfinite, isnan

import numpy as np
from msgspec.structs import asdict, astuple, replace

from stepbot.engines.description import Description
from stepbot.engines.observation import NEVER_ZERO, ObservedJoint, Quantity
from stepbot.geometry.spatial import IDENTITY, ZERO3, Pose, tidy
from stepbot.robot.closures import DoesNotClose, Loops
from stepbot.robot.kinematics import MOVING, NO_BOUND, complete, displacement, mimic_relation
from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Base, Joint, JointDynamics, JointKind, Limit, Link, Robot
from stepbot.robot.validity import open_closures

from .finding import LOST, MOVED, OPEN_LIMIT, REARRANGED, TAKEN_AS_FIXED, UNSUPPORTED, Finding

_OF_LOCKED = (
    *(Quantity.JOINTS, Quantity.AXES, Quantity.LIMITS, Quantity.DYNAMICS, Quantity.MIMIC, Quantity.POSES),
    *(Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS, Quantity.INITIAL),
)
"""Quantities in which a joint that its limits lock differs from a fixed one."""
_TWO_ROBOTS = "a conversion is of one robot: remove the other one from the file"
_RESIDUE = 1e-9
"""Difference [rad], [m] of positions that is numeric residue."""
_WIDEN = "no pose within all limits that closes the loops was found near it: widen the limits to include this position"
_UNLIMITED = (
    *(("lower", -inf), ("upper", inf), ("velocity", inf), ("effort", inf)),
    *(("acceleration", inf), ("deceleration", inf), ("jerk", inf)),
)


def tree_of(description: Description, findings: list[Finding]) -> tuple[list[Joint], dict[str, Link]]:
    """Joints from the root on, each parent before its children, and the links that stand between several joints."""
    seen = description.observation
    names = dict.fromkeys(link.name for link in seen.links)
    above: dict[str, list[ObservedJoint]] = {}
    for joint in seen.joints:
        if joint.child in names and joint.parent in names:
            above.setdefault(joint.child, []).append(joint)
        else:
            findings.append(Finding(UNSUPPORTED, f"joint '{joint.name}' between '{joint.parent}' and '{joint.child}'"))
    root = next((name for name in names if name not in above), next(iter(names)))
    findings.extend(
        Finding(UNSUPPORTED, f"joint '{joint.name}' closes a cycle of links") for joint in above.pop(root, [])
    )
    return _Tree(description, above, findings).grown(root)


def surroundings_of(description: Description) -> frozenset[str]:
    """Links of what lies loose around the robot: trees without joints that move freely beside one with joints.

    If the robot itself moves freely, those that stand in the world are not part of it either. What a closure of the
    robot holds is.
    """
    seen = description.observation
    if not description.free_roots:
        return frozenset()
    above = {joint.child: joint.parent for joint in seen.joints}
    roots: dict[str, str] = {}
    for link in seen.links:
        one, way = link.name, dict[str, None]()
        while one in above and one not in roots and one not in way:
            way[one] = None
            one = above[one]
        roots |= dict.fromkeys((*way, one), roots.get(one, one))
    jointed = {roots[joint.child] for joint in seen.joints if joint.kind != JointKind.FIXED}
    held = {roots.get(link) for closure in seen.closures or () for link in (closure.link_a, closure.link_b)}
    if not jointed:
        return frozenset()
    free, loose = set(description.free_roots), set(roots.values()) - jointed - held
    objects = loose if jointed <= free else loose & free
    return frozenset(link for link, root in roots.items() if root in objects)


def without_links(description: Description, links: frozenset[str]) -> Description:
    """The description without these links, which no joint connects to the others."""
    if not links:
        return description
    seen = description.observation
    root = next(link.name for link in seen.links if link.name not in links)
    return replace(
        description,
        observation=seen.without(links, Base.FLOATING if root in description.free_roots else Base.FIXED),
        X_WR=description.X_WR @ seen.poses[0][root],
        shapes=tuple(shape for shape in description.shapes if shape.link not in links),
        assumed=tuple(link for link in description.assumed if link not in links),
    )


class _Tree:
    """A tree that grows from its root."""

    def __init__(
        self, description: Description, above: Mapping[str, list[ObservedJoint]], findings: list[Finding]
    ) -> None:
        seen = description.observation
        self._X_PC, self._poses = description.X_PC, seen.poses[0] if seen.poses else {}
        self._free = set(description.free_roots)
        self._are_loose_links_unknown = seen.format == "urdf"
        self._names = [link.name for link in seen.links]
        self._above, self._findings = above, findings
        self._below: dict[str, list[str]] = {}
        for child, joints in above.items():
            self._below.setdefault(joints[0].parent, []).append(child)
        self._joints: list[Joint] = []
        self._extra: dict[str, Link] = {}
        self._taken = {*self._names, *(joint.name for joint in seen.joints)}

    def grown(self, root: str) -> tuple[list[Joint], dict[str, Link]]:
        """All joints; links that none of them connects to the root are fixed to it."""
        reached = set[str]()
        roots = (name for name in self._names if name not in self._above)
        for top in (root, *roots, *self._names):  # those of the last are on cycles
            if top in reached:
                continue
            if top != root:
                self._join(root, top)
                for joint in self._above.get(top, [])[:1]:
                    self._below[joint.parent].remove(top)
            grown = [top]
            for parent in grown:
                for child in self._below.pop(parent, []):
                    self._joints += self._chain(child)
                    grown.append(child)
            reached.update(grown)
        return self._joints, self._extra

    def _join(self, root: str, loose: str) -> None:
        """Fix the root of another tree to the root."""
        known = root in self._poses and loose in self._poses
        X_RL = self._poses[root].inverse() @ self._poses[loose] if known else IDENTITY
        name = free_name(f"{loose}_fixed", "_joint", self._taken)
        self._joints.append(Joint(name, JointKind.FIXED, root, loose, X_RL))
        free = [link for link in (loose, root) if link in self._free]
        if free:
            text = f"link '{loose}' is not connected to '{root}': '{free[0]}' moves freely"
            self._findings.append(Finding(UNSUPPORTED, text, help=(_TWO_ROBOTS,)))
        else:
            text = f"link '{loose}' is not connected to '{root}'; a fixed joint holds it in its place"
            code = TAKEN_AS_FIXED if self._are_loose_links_unknown else REARRANGED
            self._findings.append(Finding(code, text, (Quantity.JOINTS,)))

    def _chain(self, child: str) -> list[Joint]:
        """The joints above a link; anchors beside its origin become links in between."""
        above = self._above[child]
        parent = above[0].parent
        strange = [joint for joint in above if joint.parent != parent]
        for joint in strange:
            text = f"joint '{joint.name}': a second parent '{joint.parent}' of link '{child}'"
            self._findings.append(Finding(UNSUPPORTED, text))
        whole = above[0] if len(above) == 1 and _is_one(above[0]) else None
        steps = [whole] if whole else [step for joint in above for step in (joint.steps or (joint,))]
        steps = [replace(step, anchor=ZERO3) if step.kind == JointKind.FIXED else step for step in steps]
        chain: list[Joint] = []
        X_PJ = self._X_PC.get(child, IDENTITY) @ Pose.of(position=steps[0].anchor)
        before = len(self._extra)
        for index, step in enumerate(steps):
            is_last = index == len(steps) - 1
            to = child if is_last and step.anchor == ZERO3 else self._between(child, index)
            name = step.name or free_name(f"{child}_fixed", "_joint", self._taken)
            chain.append(_joint(step, name, parent, to, X_PJ, self._findings))
            if not is_last:
                X_PJ = Pose.of(position=np.subtract(steps[index + 1].anchor, step.anchor))
            parent = to
        if parent != child:
            X_JC = Pose.of(position=np.negative(steps[-1].anchor))
            name = free_name(f"{child}_fixed", "_joint", self._taken)
            chain.append(Joint(name, JointKind.FIXED, parent, child, X_JC))
        added = list(self._extra)[before:]
        if added:
            many = f"{len(steps)} joints" if len(steps) > 1 else f"joint '{steps[0].name}' beside its origin"
            links = ", ".join(f"'{name}'" for name in added)
            self._findings.append(
                Finding(REARRANGED, f"link '{child}': {many}, so links without mass are added: {links}")
            )
        return chain

    def _between(self, child: str, index: int) -> str:
        name = free_name(f"{child}_{index + 1}", "_link", self._taken)
        self._extra[name] = Link(name)
        return name


def _is_one(joint: ObservedJoint) -> bool:
    """Whether a joint of several steps is one joint of the model, with the same limits and forces in all of them."""
    if joint.steps and not joint.name:  # joints of another writer, with names of their own
        return False
    numbers = [value for part in (joint.limit, joint.dynamics) if part for value in astuple(part)]
    anchors = {step.anchor for step in joint.steps}
    return not any(map(isnan, numbers)) and anchors <= {ZERO3} and not _differing(joint)


def _differing(joint: ObservedJoint) -> bool:
    """Whether the steps of a multi-dof joint have limits or forces that the model's one joint cannot have."""
    of_steps = [step for step in joint.steps if step.kind != "ball"]
    bare = joint.kind == JointKind.UNIVERSAL or all(
        (step.limit or Limit()).effort == inf and step.dynamics in (None, JointDynamics()) for step in of_steps
    )
    free = all((step.limit or Limit()).lower == -inf and (step.limit or Limit()).upper == inf for step in of_steps)
    return not (bare and free)


def _joint(joint: ObservedJoint, name: str, parent: str, child: str, X_PC: Pose, findings: list[Finding]) -> Joint:
    known = joint.kind in set(JointKind)
    kind = JointKind(joint.kind) if known else JointKind.FIXED
    if not known:
        findings.append(
            Finding(UNSUPPORTED, f"joint '{name}' of type '{joint.kind}' is not supported: fixed in its place")
        )
    limit = joint.limit or Limit()
    unknown = [field for field, _ in _UNLIMITED if isnan(getattr(limit, field))]
    if unknown:
        text = f"joint '{name}': {' and '.join(unknown)} limit, not the same in both directions: not converted"
        findings.append(Finding(LOST, text))
    if kind is JointKind.REVOLUTE and limit.lower <= -NO_BOUND and limit.upper >= NO_BOUND:
        kind, limit = JointKind.CONTINUOUS, replace(limit, lower=-inf, upper=inf)
    zero = [field for field in NEVER_ZERO if getattr(limit, field) == 0.0]
    if zero:
        text = f"joint '{name}': {' and '.join(zero)} limit of 0, at which nothing moves: read as unlimited"
        findings.append(Finding(OPEN_LIMIT, text))
        limit = replace(limit, **dict.fromkeys(zero, inf))
    if kind is JointKind.BALL and isfinite(limit.upper):
        text = f"joint '{name}': the cone of {limit.upper:g} rad that limits it: not converted"
        findings.append(Finding(LOST, text, (Quantity.JOINTS, Quantity.LIMITS)))
        limit = replace(limit, lower=-inf, upper=inf)
    axis = joint.axis or (0.0, 0.0, 1.0)
    if kind.has_axis and not 0.99 < float(np.linalg.norm(axis)) < 1.01:
        findings.append(Finding(UNSUPPORTED, f"joint '{name}' without an axis is not supported: fixed in its place"))
        kind = JointKind.FIXED
    if kind is JointKind.FIXED:
        return Joint(name, kind, parent, child, X_PC)
    return Joint(
        name,
        kind,
        parent,
        child,
        X_PC,
        axis,
        joint.axis2 or (1.0, 0.0, 0.0),
        Limit(*(none if isnan(bound := getattr(limit, field)) else bound for field, none in _UNLIMITED)),
        _dynamics(joint.dynamics or JointDynamics()),
        joint.mimic if kind in MOVING else None,
        joint.pitch or 0.0,
    )


def _dynamics(dynamics: JointDynamics) -> JointDynamics:
    """Passive forces; the rest position of a spring without stiffness has no meaning."""
    values = asdict(dynamics)
    known = {name: 0.0 if isnan(value) else value for name, value in values.items()}
    return JointDynamics(**(known if known["stiffness"] else {**known, "spring_reference": 0.0}))


def with_locked_fixed(joints: Sequence[Joint], of_urdf: bool, findings: list[Finding]) -> tuple[Joint, ...]:
    """The joints; one whose limits leave a single position is fixed there, and so is what follows it.

    MuJoCo has no such joint, and ROS moves it as little as a fixed one.

    Args:
        of_urdf: Whether they are of a URDF, which is compared with joints at 0 fixed.
    """
    at: dict[str, float] = {}
    text = {}
    for joint in joints:
        if joint.kind in MOVING and joint.mimic is None and joint.limit.lower == joint.limit.upper:
            at[joint.name] = joint.limit.lower
            text[joint.name] = f"joint '{joint.name}': lower and upper limit are both {joint.limit.lower:g}"
    followers = {joint.name: joint.mimic for joint in joints if joint.mimic is not None}
    while held := {name: mimic for name, mimic in followers.items() if mimic.joint in at and name not in at}:
        for name, mimic in held.items():
            at[name] = mimic.multiplier * at[mimic.joint] + mimic.offset
            text[name] = f"joint '{name}' mimics '{mimic.joint}', which cannot move"
    at = {name: q for name, q in at.items() if isfinite(q)}  # others are rejected with the robot's numbers
    for name, q in at.items():
        differs = () if of_urdf and q == 0.0 else _OF_LOCKED
        findings.append(Finding(OPEN_LIMIT, f"{text[name]}: converted to a fixed joint", differs))
    return tuple(
        Joint(one.name, JointKind.FIXED, one.parent, one.child, tidy(one.X_PC @ displacement(one, at[one.name])))
        if one.name in at
        else one
        for one in joints
    )


def without_broken_mimics(joints: Sequence[Joint], findings: list[Finding]) -> tuple[Joint, ...]:
    """The joints; a mimic whose leader does not move, or that follows itself, is dropped and listed."""
    by_name = {joint.name: joint for joint in joints if joint.kind in MOVING}
    kept = []
    for joint in joints:
        leader: Joint | None = joint
        for _ in joints:
            if leader is None or leader.mimic is None:
                break
            leader = by_name.get(leader.mimic.joint)
        if joint.mimic is not None and (leader is None or leader.mimic is not None):
            text = f"joint '{joint.name}' mimics '{joint.mimic.joint}', which does not move by itself"
            findings.append(Finding(UNSUPPORTED, text))
            joint = replace(joint, mimic=None)
        kept.append(joint)
    return tuple(kept)


def at_initial(robot: Robot, initial: Mapping[str, float], findings: list[Finding] | None) -> Robot:
    """The robot in the initial pose of its file; with ``findings``, joints outside their limits are moved to them.

    Leaders are moved to where their followers are within limits, too, and the other joints of a loop follow. Loops that
    are open are closed near their pose, as engines do in the first steps.
    """
    leaders = [joint for joint in robot.joints if joint.kind in MOVING and joint.mimic is None]
    stated = {joint.name: initial.get(joint.name, 0.0) for joint in robot.joints}
    robot = _with_followers(robot, stated)
    if findings is None:
        return robot
    bounds = _bounds(robot)
    inside = {
        joint.name: min(max(stated[joint.name], bounds[joint.name][0]), bounds[joint.name][1]) for joint in leaders
    }
    clamped = {name for name, q in inside.items() if q != stated[name]}
    is_open = any(open_closures(robot))
    loops = Loops(robot) if robot.closures and (clamped or is_open) else None
    opened = loops is not None and (is_open or not clamped.isdisjoint(loops.involved))
    closed = _closed(loops, stated | inside, clamped, bounds) if loops is not None and opened else stated | inside
    placed = _with_followers(robot, closed or stated | inside)
    for joint in placed.joints:
        q, before = joint.drawn_position, stated[joint.name]
        if joint.name in clamped:
            why = f"is outside the limits {bounds[joint.name][0]:g} to {bounds[joint.name][1]:g}"
        elif joint.kind in MOVING and joint.mimic is None and abs(q - before) > _RESIDUE:
            why = f"does not close the loops{' where others are within their limits' if clamped else ''}"
        elif joint.mimic is not None and joint.name in initial and abs(q - before) > _RESIDUE:
            why = "is not where its mimic puts it"
        else:
            continue
        text = f"joint '{joint.name}': initial position {before:g} {why}: {q:g} taken"
        findings.append(Finding(MOVED, text, (Quantity.INITIAL,), () if closed else (_WIDEN,)))
    return placed


def _bounds(robot: Robot) -> dict[str, tuple[float, float]]:
    """Limits of the independent joints, within those of their followers where some position is within both.

    Swapped limits are an error of their own, and bound nothing.
    """
    limits = {joint.name: (joint.limit.lower, joint.limit.upper) for joint in robot.joints}
    bounds = {name: ends if ends[0] <= ends[1] else (-inf, inf) for name, ends in limits.items()}
    for joint in robot.joints:
        if joint.mimic is None:
            continue
        leader, multiplier, offset = mimic_relation(robot, joint.name)
        if multiplier:
            low, high = sorted((end - offset) / multiplier for end in bounds[joint.name])
            low, high = max(low, bounds[leader][0]), min(high, bounds[leader][1])
            bounds[leader] = (low, high) if low <= high else bounds[leader]
    return bounds


def _closed(
    loops: Loops, guess: Mapping[str, float], held: Set[str], bounds: Mapping[str, tuple[float, float]]
) -> dict[str, float] | None:
    """The pose near a guess that closes the loops within all bounds; None if none is found.

    Joints that are held stay where they are, as do those of several degrees of freedom.
    """
    names, held = loops.tree.independent, {*held, *(name for name in loops.tree.independent if name not in guess)}
    u = loops.tree.vector({name: guess.get(name, 0.0) for name in names})
    low, high = np.array([bounds.get(name, (-inf, inf)) for name in names]).T
    for _ in names:
        try:
            u, _ = loops.closed(u, [i for i, name in enumerate(names) if name not in held])
        except DoesNotClose:
            return None
        outside = np.abs(np.clip(u, low, high) - u) > _RESIDUE
        if not outside.any():
            break
        held |= {name for name, is_outside in zip(names, outside.tolist(), strict=True) if is_outside}
        u = np.clip(u, low, high)
    return {**guess, **dict(zip(names, u.tolist(), strict=True))}


def _with_followers(robot: Robot, q: Mapping[str, float]) -> Robot:
    """The robot in a pose, with followers where their leaders put them."""
    placed = replace(robot, joints=tuple(replace(joint, drawn_position=q[joint.name]) for joint in robot.joints))
    leaders = {joint.name: q[joint.name] for joint in robot.joints if joint.kind in MOVING and joint.mimic is None}
    full = complete(robot, leaders)
    joints = (
        joint if joint.mimic is None else replace(joint, drawn_position=full[joint.name]) for joint in placed.joints
    )
    return replace(placed, joints=tuple(joints))
