"""A draft as the text of a sidecar: every guess with its evidence, and a REVIEW mark if the evidence is weak.

The text passes ``check --step`` and converts as it is. Guesses that are not accepted are comments only, as lines to
uncomment. Same draft, same bytes.
"""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from stepbot.diagnostics import cut, one_line
from stepbot.draft.draft import Alternative, Draft, DraftJoint, DraftLink, Models
from stepbot.draft.text.connection_text import closure_lines, fused_lines, inertial_lines, joint_lines
from stepbot.draft.text.densities import typical_density
from stepbot.draft.text.draft_names import DraftNames, names_of
from stepbot.draft.text.values import alternative_origin, angles, comment, flow, lengths, listed, number, origin_text
from stepbot.robot.model import Base, JointKind
from stepbot.runtime.file import resolved
from stepbot.sidecar.contact import MATERIALS
from stepbot.sidecar.starter import robot_name, scalar
from stepbot.step.assembly import Assembly
from stepbot.step.features.ground import Standing, standing
from stepbot.step.structure.paths import quoted

SCHEMA_FILE = "robot-1.schema.json"
"""Name of the schema in the first line, for editors."""
_COLLISION = "collision: auto"
"""Sidecars without this key keep their meaning, a hull for each component; new ones get fitted shapes."""
_OFFERED = 12
"""Maximum number of axes that were found but not drafted."""
_OVERVIEW = 40
"""Maximum number of links in the overview."""
_POSES = 200
"""Poses in which a drafted robot is searched for links whose collision shapes always overlap."""


def sidecar_text(draft: Draft, step: str, *, encoding: str = "", schema: str = SCHEMA_FILE) -> str:
    """The sidecar of a draft.

    Args:
        step: Path of the STEP file in the sidecar: relative to the sidecar, with forward slashes.
        encoding: Code page of the names in the STEP, if its reader was given one.
        schema: Path of the JSON Schema, for editors; empty to omit that line.

    Returns:
        YAML, with a line feed at the end of every line.
    """
    names = names_of(draft)
    names_of_joints = dict(zip((joint.name for joint in draft.joints), names.joints, strict=True))
    lines = [f"# yaml-language-server: $schema={schema}"] if schema else []
    lines += _introduction(draft, names)
    lines += ["version: 1", f"robot: {scalar(robot_name(draft.robot))}", f"step: {scalar(step)}"]
    lines += [*([f"step_encoding: {scalar(encoding)}"] if encoding else [])]
    lines += [*_stand(draft, names), "", *_answers(draft)]
    lines += _defaults(draft)
    lines += ["links:"]
    proposed = _contacts(draft)
    for link in draft.links:
        lines += _link(link, names, is_root=link.name == draft.root)
        lines += [f"    contact: {material}  {why}" for material, why in proposed.get((link.name, ""), ())]
        lines += (
            ["    collision: {merge: wheel}"]
            if any(contact.rolls and contact.link == link.name for contact in draft.contacts)
            else []
        )
    fused = list(zip(draft.fused, names.freed, strict=True))[:_OFFERED]
    if fused:
        lines.append(
            "  # Fused parts that look movable. To free one, uncomment it and its joint, and take it off its link."
        )
        lines += [f"  # {scalar(name)}: {flow([('parts', listed([one.moving]))])}" for one, name in fused]
        lines += _more(len(draft.fused) - len(fused))
    of_parts = [(part, *one) for (_, part), joints in proposed.items() if part for one in joints]
    own = [f"  {quoted(path)}: {{ignore: true}}  # frames of joints" for path in draft.markers]
    own += [f"  {quoted(part)}: {{contact: {material}}}  {why}" for part, material, why in of_parts]
    lines += ["", "parts:", *own] if own else []
    if draft.joints or fused:
        lines += ["", "joints:" if draft.joints else "# joints:"]
        for joint, name in zip(draft.joints, names.joints, strict=True):
            lines += joint_lines(joint, name, names, names_of_joints)
        for one, name in fused:
            lines += fused_lines(one, name, names)
    closures = [
        line
        for closure, name in zip(draft.closures, names.closures, strict=True)
        for line in closure_lines(closure, name, names)
    ]
    if closures:
        has_active = any(not line.lstrip().startswith("#") for line in closures)
        lines += ["", "closures:" if has_active else "# closures:", *closures]
    lines += _frames(draft, names)
    lines += _actuators(draft, names)
    lines += _offered(one for one in draft.offered if one not in draft.fused)
    return "\n".join(lines) + "\n"


def _introduction(draft: Draft, names: DraftNames) -> list[str]:
    basis = f"--from {one_line(draft.source)}`" if draft.source else "` from the STEP: shapes, contacts, names"
    lines = [
        f"# Drafted by `stepbot init{' ' * bool(draft.source)}{basis}. A score from 0 to 1 ranks the evidence.",
        "# Check each REVIEW, fill in each `todo`, then run `stepbot check --step` and `stepbot convert`.",
    ]
    for note in draft.notes:
        lines += comment(f"Note: {note}")
    return [*lines, *_overview(draft, names)]


def _overview(draft: Draft, names: DraftNames) -> list[str]:
    """The robot as a tree: links below what moves them, each with its joint; and how many parts were fused."""
    if not draft.joints:
        return []
    below: dict[str, list[DraftJoint]] = {}
    for joint in draft.joints:
        below.setdefault(joint.parent, []).append(joint)
    tree, waiting = [f"{names.links[draft.root]}  (root)"], [(1, joint) for joint in below.get(draft.root, [])]
    while waiting:
        depth, joint = waiting.pop(0)
        kind = joint.type.value if joint.confidence.is_chosen else "fixed, for want of evidence"
        mark = "  REVIEW" if joint.is_reviewed else ""
        tree.append(f"{'  ' * depth}{names.links[joint.child]}: {kind}, {joint.confidence.score:.2f}{mark}")
        waiting[:0] = [(depth + 1, one) for one in below.get(joint.child, [])]
    counts = {
        "joint": len(draft.joints),
        "closed loop": len(draft.closures),
        "fused part that may move": len(draft.fused),
    }
    words = [f"{count} {_plural(what) if count > 1 else what}" for what, count in counts.items() if count]
    lines = [f"Found: {', '.join(words)}", *(f"  {line}" for line in cut(tree, _OVERVIEW))]
    return ["#", *(f"# {one_line(line)}" for line in lines), "#"]


def _plural(what: str) -> str:
    noun, _, rest = what.partition(" that ")
    return f"{noun}s that {rest}" if rest else f"{noun}s"


def _stand(draft: Draft, names: DraftNames) -> list[str]:
    """Whether the base is fixed, and the frame of the root or the axis that is up; nothing for the defaults."""
    lines = [f"base: {draft.base}"] if draft.base is not Base.FIXED else []
    if draft.root_frame is not None:
        root = [("link", scalar(names.links[draft.root])), ("frame", origin_text(draft.root_frame))]
        lines.append(f"root: {flow(root)}")
    elif draft.standing is not None:
        lines += comment(f"REVIEW: drawn with {draft.standing.up} up? {draft.standing}")
        lines.append(f"root: {{up: {draft.standing.up}}}")
    return lines


def _answers(draft: Draft) -> list[str]:
    """Answers that were used, and the questions left, each as a line to uncomment."""
    lines = [f"  {scalar(name)}: {scalar(value)}" for name, value in draft.answers.items()]
    lines = ["answers:  # to questions of `stepbot init`, which uses them again with --force", *lines] if lines else []
    if draft.questions:
        lines += [
            "# What decides most: uncomment a line with your answer and run `stepbot init --force`, or run `init -i`.",
            *([] if draft.answers else ["# answers:"]),
        ]
    for question in draft.questions:
        others = ", ".join(option.value for option in question.options if option is not question.drafted)
        lines += comment(question.text, 2)
        lines.append(
            f"  # {scalar(question.name)}: {scalar(question.drafted.value)}  # as drafted; or {one_line(others)}"
        )
    return [*lines, ""] if lines else []


def _frames(draft: Draft, names: DraftNames) -> list[str]:
    lines = ["", "frames:"] if draft.frames else []
    for frame, name in zip(draft.frames, names.frames, strict=True):
        link = scalar(names.links[frame.link])
        pose = [("xyz", lengths(frame.X_LF.position)), ("rpy", angles(frame.X_LF.rpy)), ("relative_to", link)]
        lines.append(f"  {scalar(name)}: {flow([('link', link), ('origin', flow(pose))])}")
    return lines


def _actuators(draft: Draft, names: DraftNames) -> list[str]:
    """Actuators of the joints that motors turn, as lines to uncomment: a motor can be driven in several ways."""
    driven = [
        (name, joint)
        for joint, name in zip(draft.joints, names.joints, strict=True)
        if joint.type.is_pair and joint.confidence.is_chosen and joint.motor
    ]
    if not driven:
        return []
    lines = [
        "",
        "# Joints that motors turn. Uncomment these lines to drive them. `motor` gives effort, velocity and inertia",
        "# (`stepbot motors NAME`); without it, add `effort` and `velocity` to `limits`.",
        "# actuators:",
    ]
    stated: set[Models] = set()
    for name, joint in driven:
        key, fitted_models = scalar(f"{name.removesuffix('_joint')}_motor"), joint.models
        if fitted_models is None:
            lines.append(f"#   {key}: {flow([('joint', scalar(name)), ('kind', 'position'), ('gains', 'auto')])}")
            continue
        model = scalar(fitted_models.family or fitted_models.names[0])
        several = f"; one of {', '.join(fitted_models.names)}" if len(fitted_models.names) > 1 else ""
        review = f"{one_line(fitted_models.why)}{several}" if fitted_models not in stated else "as above"
        stated.add(fitted_models)
        keys = [("joint", scalar(name)), ("motor", model), ("part", quoted(joint.motor))]
        lines.append(f"#   {key}: {flow(keys)}  # REVIEW: {review}")
    return lines


def _defaults(draft: Draft) -> list[str]:
    """Densities that the STEP lacks, typical ones by name and a placeholder for others; collision shapes, contacts."""
    lines: list[str] = []
    if draft.equal_density:
        text = (
            f"REVIEW: all parts have {number(draft.equal_density)} kg/m^3 in the STEP; a default of some CAD programs;"
        )
        lines += comment(f"{text} if it is one, write `step_density: ignore` and give densities below.")
    named = [name for name in draft.without_density if name]
    known = [(name, typical) for name in named if (typical := typical_density(name)) is not None]
    unknown = [name for name in named if typical_density(name) is None]
    if known:
        lines += ["materials:"]
        for name, typical in known:
            review = f"# REVIEW: typical of {typical.material}; the STEP names it without a density"
            lines += [f"  {scalar(name)}: {{density: {number(typical.density)} kg/m^3}}  {review}"]
    if unknown:
        lines += comment(f"REVIEW: materials without a known density, which use `defaults`: {', '.join(unknown)}")
    if unknown or "" in draft.without_density:
        reason = "parts without a density have 1000 kg/m^3 until then: weigh one, or use their material's"
        lines += [f"defaults: {{density: todo, {_COLLISION}}}  # REVIEW: {reason}"]
    else:
        lines += [f"defaults: {{{_COLLISION}}}"]
    if len(draft.links) > 2:  # two are adjacent
        lines += [
            f"self_collision: {{samples: {_POSES}}}  # excludes contacts of links that overlap in all of these poses"
        ]
    return [*lines, ""]


def _link(link: DraftLink, names: DraftNames, *, is_root: bool) -> list[str]:
    lines: list[str] = []
    facts = "; ".join(link.confidence.evidence)
    if not link.confidence.is_sure:
        lines += comment(f"REVIEW: which parts move as one here (score {link.confidence.score:.2f}): {facts}", 2)
    elif facts:
        lines += comment(facts, 2)
    if link.drawn:
        lines += comment(f"in the CAD: '{link.drawn}'", 2)
    lines += [f"  {scalar(names.links[link.name])}:{'  # root: no joint moves it' if is_root else ''}"]
    if link.rest:
        lines += ["    rest: true  # everything that no other link claims"]
    if link.parts or not link.rest:
        lines += _parts(link.parts)
    if link.inertial is not None:
        lines += inertial_lines(link.inertial)
    return lines


def _contacts(draft: Draft) -> dict[tuple[str, str], list[tuple[str, str]]]:
    """By link and part, a material, and a comment: its friction and the reason beside the first of several."""
    pairs: dict[tuple[str, str], list[tuple[str, str]]] = {}
    stated: set[str] = set()
    for contact in draft.contacts:
        review = f"REVIEW: {contact.why}; friction {number(MATERIALS[contact.material].sliding)}"
        pairs[contact.link, contact.part] = [
            (contact.material, f"# {review if contact.why not in stated else 'as above'}")
        ]
        stated.add(contact.why)
    return pairs


def _parts(paths: Sequence[str]) -> list[str]:
    """``parts`` on one line if they fit, else one path per line."""
    line = f"    parts: {listed(paths)}"
    return [line] if len(line) <= 100 else ["    parts:", *(f"      - {quoted(path)}" for path in paths)]


def _more(count: int) -> list[str]:
    return [f"  # {count} more: `stepbot init --json` lists all"] if count > 0 else []


def _offered(offered: Iterable[Alternative]) -> list[str]:
    distinct = list(offered)
    shown = distinct[:_OFFERED]
    if not shown:
        return []
    lines = ["", "# Further axes, drafted as fixed. To use one, add a link for the moving parts and such a joint:"]
    for one in shown:
        between, facts = f"{quoted(one.a)} and {quoted(one.b)}", "; ".join(one.confidence.evidence)
        lines += comment(f"  {one.type}, score {one.confidence.score:.2f}, of {between}: {facts}")
        if one.type is not JointKind.FIXED and one.point is not None:
            lines += [f"#     origin: {alternative_origin(one.point, one.direction)}"]
    return [*lines, *_more(len(distinct) - len(shown))]


def relative_step(step: Path, sidecar: Path) -> str:
    """``step`` relative to the folder of ``sidecar``, with forward slashes; absolute if there is no relative path.

    Symbolic links in the folders are resolved, since ``..`` is relative to their target.
    """
    target = resolved(step.parent) / step.name
    try:
        relative = os.path.relpath(target, resolved(sidecar.parent))
    except ValueError:  # another Windows drive
        return target.as_posix()
    return Path(relative).as_posix()


_SEVERAL = 4
"""Number of solids from which a common density is suspected to be a CAD program's default."""


def without_density(assembly: Assembly) -> tuple[str, ...]:
    """Materials of solids without a density in the STEP, unique and sorted; ``""`` for solids without a material."""
    return tuple(
        sorted({c.material for c in assembly.components if _has_volume(assembly, c.index) and c.density is None})
    )


def equal_density(assembly: Assembly) -> float:
    """Density [kg/m^3] shared by all of several solids; 0 if they differ, or are few."""
    densities = [c.density for c in assembly.components if _has_volume(assembly, c.index)]
    return (densities[0] or 0.0) if len(densities) >= _SEVERAL and len(set(densities)) == 1 else 0.0


def _has_volume(assembly: Assembly, index: int) -> bool:
    body = assembly.components[index].body
    return body >= 0 and assembly.bodies[body].has_volume


def drawn_up(draft: Draft, assembly: Assembly) -> Standing | None:
    """Evidence that an axis other than z is up; None if there is none."""
    base = {draft.root}
    for joint in draft.joints:  # in tree order
        if joint.type is JointKind.FIXED and joint.parent in base:
            base.add(joint.child)
    parts = [index for link in draft.links if link.name in base for index in link.components]
    moving = [joint for joint in draft.joints if joint.parent in base and joint.child not in base]
    return standing(assembly, parts, [joint.direction for joint in moving if joint.direction is not None])
