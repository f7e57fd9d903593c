"""What gears and racks that mesh indicate: what they move on, and the shafts that they are fixed to."""

from collections.abc import Sequence

from stepbot.draft.contacts.relations import Via
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.contacts.teeth import Gear, Mesh, RackMesh
from stepbot.draft.draft import CHOSEN
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Apart, Evidence, JointEvidence
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.names import Role
from stepbot.robot.model import JointKind

_REVIEW = "a gear that meshes with another one; no shaft is drawn"
_OF_RACK = "a rack that meshes with a gear: it slides along its teeth"
_TURNS_ON = "a gear that meshes with what turns in the other part"
_ON_SCREW = "a gear that meshes, and that one screw or pin alone holds"
_REVIEW_ON = "what holds the one gear would lock the other one"
_BY_BELT = "a belt runs around it; nothing else shows that it turns"
_SCORE, _APART, _KEYED, _BELTED = 0.7, 0.8, 0.9, 0.785
"""Scores of a joint of a gear, of two gears that mesh being no link, of a gear on a shaft that turns, and by a belt."""
_BEYOND = 6e-3
"""Gap [m] along its axis from a gear to a round face, up to which an undrawn shaft may be in both."""
_ALONG = 1e-2
"""Cosine up to which a face lets a rack slide."""
SAME_GEAR = 3e-4
"""Distance [m] up to which the axis of a gear is that of a joint."""


@rule(170)
def gear_evidence(survey: Survey, evidence: Evidence) -> None:
    """Add what gears indicate.

    Those that mesh move relative to each other. One without a shaft turns on the part with a round face on its line
    nearby. One on a shaft that turns, driven or in a bearing, is fixed to it.
    """
    _fix_to_shafts(survey, evidence)
    for pair in survey.rack_meshes:
        a, b = sorted((pair.gear.part, pair.part))
        evidence.apart.append(Apart(_APART, a, b))
        guide = _guide(survey, pair)
        if guide is not None:
            a, b = sorted((guide, pair.part))
            axis = Axis(pair.rack.point, pair.rack.along)
            why = f"the rack '{survey.parts[pair.part].path}' meshes with '{survey.parts[pair.gear.part].path}'"
            slides = (
                h
                for h in evidence.joints
                if h.type == JointKind.PRISMATIC and h.score >= CHOSEN and guide in (h.a, h.b)
            )
            if any(h.axis.is_along(pair.rack.along) for h in slides) and guide not in _hosts(survey, pair.gear):
                evidence.weld(_KEYED, a, b, "a rack on what slides along its teeth")
                continue
            evidence.joint(JointEvidence(_APART, a, b, JointKind.PRISMATIC, axis, why, review=_OF_RACK))
    held = {i for h in evidence.joints for i in (h.a, h.b) if h.drives}
    for mesh in survey.meshes:
        a, b = sorted((mesh.one.part, mesh.two.part))
        evidence.apart.append(Apart(_APART, a, b))
        _free_from_hosts(survey, mesh, evidence)
    for gear in {gear.part: gear for mesh in survey.meshes for gear in (mesh.one, mesh.two)}.values():
        on_axis = any(r.turns is not None and r.turns.same(gear.axis) for _, r in survey.around(gear.part))
        host = None if on_axis or gear.part in held else _host(survey, gear)
        if host is not None:
            a, b = sorted((gear.part, host))
            why = f"the gear '{survey.parts[gear.part].path}' turns about its own axis"
            evidence.joint(JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, gear.axis, why, review=_REVIEW))


@rule(180)
def belt_evidence(survey: Survey, evidence: Evidence) -> None:
    """A belt turns what it runs around, on what holds that, unless something turns about its axis already."""
    turning = [h for h in evidence.joints if h.type == JointKind.REVOLUTE and h.score >= CHOSEN]
    for part, axis in survey.belted.items():
        held = [k for k in _on_axis(survey, part, axis, through_screws=True) if k not in survey.belted]
        group = {part, *held, *(k for i in held for k in _on_axis(survey, i, axis))}
        if Role.BEARING in survey.parts[part].roles or survey.holders(part):
            continue
        if held and not any(h.axis.same(axis, SAME_GEAR) and group & {h.a, h.b} for h in turning):
            a, b = sorted(
                (part, min(held, key=lambda k: (survey.relation(part, k) is None, -survey.parts[k].volume, k)))
            )
            why = f"a belt runs around '{survey.parts[part].path}'"
            evidence.joint(
                JointEvidence(_BELTED, a, b, JointKind.REVOLUTE, axis, why, survey.relation(a, b), review=_BY_BELT)
            )


def _guide(survey: Survey, mesh: RackMesh) -> int | None:
    """The part that a rack lies on, and that nothing but faces along its teeth holds; the one with most area.

    Of a rack that touches nothing else, what its gear turns in.
    """
    along, ranked = mesh.rack.along, []
    for other, r in survey.around(mesh.part):
        is_free = all(abs(float(patch.normal @ along)) < _ALONG for patch in r.patches) and not r.sockets
        if other != mesh.gear.part and r.patches and is_free and all(fit.axis.is_along(along) for fit in r.fits):
            ranked.append((-round(r.area, 9), other))
    if not ranked and all(other == mesh.gear.part for other, _ in survey.around(mesh.part)):
        # Drawn with clearance on all sides: what its gear turns in guides it.
        ranked = [(-survey.parts[k].volume, k) for k in _hosts(survey, mesh.gear)]
    return min(ranked)[-1] if ranked else None


def _hosts(survey: Survey, gear: Gear) -> set[int]:
    """What the shaft of a gear turns in; its shaft, if that touches nothing else about its axis."""
    shafts = {gear.part, *_on_axis(survey, gear.part, gear.axis)}
    hosts = {k for i in shafts for k in _on_axis(survey, i, gear.axis)} - shafts
    return hosts or shafts - {gear.part}


def _on_axis(survey: Survey, part: int, axis: Axis, *, through_screws: bool = False) -> list[int]:
    """The larger parts that touch a part about a line, or a screw in it."""
    about = [r.other(part) for r in survey.near.get(part, ()) if r.turns is not None and r.turns.same(axis, SAME_GEAR)]
    held = [i for i in about if i not in survey.small]
    for screw in (i for i in about if i in survey.small and through_screws):
        held += [k for k in _on_axis(survey, screw, axis) if k != part]
    return list(dict.fromkeys(held))


def _free_from_hosts(survey: Survey, mesh: Mesh, evidence: Evidence) -> None:
    """Add that each gear of a mesh moves relative to what the other one turns in, which would else be locked."""
    for gear, mate in ((mesh.one, mesh.two), (mesh.two, mesh.one)):
        for host in sorted(_hosts(survey, gear) - {mate.part}):
            a, b = sorted((host, mate.part))
            r = survey.relation(a, b)
            evidence.apart.append(Apart(_APART, a, b))
            if r is not None and r.turns is not None and r.turns.same(mate.axis, SAME_GEAR):
                evidence.joint(
                    JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, mate.axis, _TURNS_ON, r, review=_REVIEW_ON)
                )
            s = survey.relation(host, gear.part)
            if s is not None and s.via == Via.BOLT and s.turns is not None and s.turns.same(gear.axis, SAME_GEAR):
                a, b = sorted((host, gear.part))
                evidence.joint(
                    JointEvidence(_SCORE, a, b, JointKind.REVOLUTE, gear.axis, _ON_SCREW, s, review=_REVIEW_ON)
                )


def _fix_to_shafts(survey: Survey, evidence: Evidence) -> None:
    turning = [h for h in evidence.joints if h.drives or h.through >= 0]
    for gear in survey.gears:
        for shaft, r in survey.around(gear.part):
            if not r.shafts or max(r.shafts, key=lambda fit: fit.length).shaft != shaft:
                continue
            if any(shaft in (h.a, h.b) and gear.part not in (h.a, h.b) and h.axis.same(gear.axis) for h in turning):
                evidence.weld(_KEYED, gear.part, shaft, "a gear on a shaft that turns")


def _host(survey: Survey, gear: Gear) -> int | None:
    """The part whose round face on the line of a gear is nearest to it."""
    low, high = survey.scene.span(gear.part, gear.axis.d)
    ranked = []
    for line in survey.contacts.lines:
        if not line.axis.same(gear.axis):
            continue
        for part, faces in line.faces.items():
            if part == gear.part or part in survey.small or Role.GEAR in survey.parts[part].roles:
                continue
            spans = [sorted(_heights(line.axis, gear.axis, (f.low, f.high))) for f in faces]
            gap = min(max(0.0, bottom - high, low - top) for bottom, top in spans)
            if gap < _BEYOND:
                ranked.append((round(gap, 6), -survey.parts[part].volume, part))
    return min(ranked)[-1] if ranked else None


def _heights(line: Axis, axis: Axis, positions: Sequence[float]) -> list[float]:
    """Positions [m] along a line as heights along the direction of an axis."""
    return [float((line.point + line.d * at) @ axis.d) for at in positions]


def mesh_between(
    meshes: Sequence[Mesh], one: Sequence[int], two: Sequence[int], axes: tuple[Axis, Axis]
) -> Mesh | None:
    """The mesh of gears of two bodies, each on the axis that its body turns about; the first body's gear is first."""
    for mesh in meshes:
        for first, second in ((mesh.one, mesh.two), (mesh.two, mesh.one)):
            on_axes = axes[0].same(first.axis, SAME_GEAR) and axes[1].same(second.axis, SAME_GEAR)
            if on_axes and first.part in one and second.part in two:
                return Mesh(first, second, mesh.belt)
    return None


def mark_geared(survey: Survey, joints: Sequence[tuple[JointEvidence, Sequence[int], Sequence[int]]]) -> None:
    """Mark the joints about the axes of gears that mesh; each is given with the parts of both of its links."""
    gears = [gear for mesh in survey.meshes for gear in (mesh.one, mesh.two)]
    for h, *sides in joints:
        turns = h.type == JointKind.REVOLUTE
        h.is_geared = turns and any(
            gear.part in side and gear.axis.same(h.axis, SAME_GEAR) for gear in gears for side in sides
        )
