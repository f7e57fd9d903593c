"""A draft as the text of a sidecar: every guess with its evidence, and a REVIEW mark if the evidence is weak.

The text passes ``check --step`` and converts as it is. Guesses that are not accepted are comments only, as lines to
uncomment. Same draft, same bytes.
"""

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from stepbot.diagnostics import one_line
from stepbot.draft.draft import Alternative, Draft, DraftLink
from stepbot.draft.text.connection_text import closure_lines, fused_lines, inertial_lines, joint_lines
from stepbot.draft.text.draft_names import DraftNames, names_of
from stepbot.draft.text.values import alternative_origin, angles, comment, flow, lengths, listed, number, origin_text
from stepbot.robot.model import Base, JointKind
from stepbot.runtime.file import resolved
from stepbot.sidecar.starter import robot_name, scalar
from stepbot.step.assembly import Assembly, BodyKind
from stepbot.step.features.ground import Standing, standing
from stepbot.step.structure.paths import quoted

SCHEMA_FILE = "robot-1.schema.json"
"""Name of the schema in the first line, for editors."""
_COLLISION = "collision: auto"
"""Sidecars without this key keep their meaning, a hull for each component; new ones get fitted shapes."""
_OFFERED = 12
"""Maximum number of axes that were found but not drafted."""


def sidecar_text(draft: Draft, step: str, *, encoding: str = "", schema: str = SCHEMA_FILE) -> str:
    """The sidecar of a draft.

    Args:
        draft: The inferred robot.
        step: Path of the STEP file in the sidecar: relative to the sidecar, with forward slashes.
        encoding: Code page of the names in the STEP, if its reader was given one.
        schema: Path of the JSON Schema, for editors; empty to omit that line.

    Returns:
        YAML, with a line feed at the end of every line.
    """
    names = names_of(draft)
    names_of_joints = dict(zip((joint.name for joint in draft.joints), names.joints, strict=True))
    lines = [f"# yaml-language-server: $schema={schema}"] if schema else []
    lines += _introduction(draft)
    lines += ["version: 1", f"robot: {scalar(robot_name(draft.robot))}", f"step: {scalar(step)}"]
    lines += [*([f"step_encoding: {scalar(encoding)}"] if encoding else [])]
    lines += [*_stand(draft, names), ""]
    lines += _defaults(draft)
    lines += ["links:"]
    for link in draft.links:
        lines += _link(link, names, is_root=link.name == draft.root)
    fused = list(zip(draft.fused, names.freed, strict=True))[:_OFFERED]
    if fused:
        lines.append(
            "  # Fused parts that look movable. To free one, uncomment its line here and the one under `joints`."
        )
        lines += [f"  # {scalar(name)}: {flow([('parts', listed([one.moving]))])}" for one, name in fused]
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


def _introduction(draft: Draft) -> list[str]:
    basis = f"--from {one_line(draft.source)}`" if draft.source else "` from the STEP: shapes, contacts, names"
    lines = [
        f"# Drafted by `stepbot init{' ' * bool(draft.source)}{basis}. A score from 0 to 1 ranks the evidence.",
        "# Check each REVIEW, fill in each `todo`, then run `stepbot check --step` and `stepbot convert`.",
    ]
    for note in draft.notes:
        lines += comment(f"Note: {note}")
    return lines


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
        name
        for joint, name in zip(draft.joints, names.joints, strict=True)
        if joint.type in (JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC)
        and joint.confidence.is_chosen
        and joint.motor
    ]
    if not driven:
        return []
    lines = [
        "",
        "# Joints that motors turn. Uncomment these lines to drive them, and add `effort` and `velocity` to `limits`.",
        "# actuators:",
    ]
    for name in driven:
        motor = scalar(f"{name.removesuffix('_joint')}_motor")
        lines.append(f"#   {motor}: {flow([('joint', scalar(name)), ('kind', 'position'), ('gains', 'auto')])}")
    return lines


def _defaults(draft: Draft) -> list[str]:
    """Densities that the STEP lacks, typical ones by name and a placeholder for the rest; and collision geometry."""
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


def _parts(paths: Sequence[str]) -> list[str]:
    """``parts`` on one line if they fit, else one path per line."""
    line = f"    parts: {listed(paths)}"
    return [line] if len(line) <= 100 else ["    parts:", *(f"      - {quoted(path)}" for path in paths)]


def _offered(offered: Iterable[Alternative]) -> list[str]:
    shown = list(offered)[:_OFFERED]
    if not shown:
        return []
    lines = [
        "",
        "# Further axes, drafted as fixed. To use one, add a link for the moving parts and such a joint:",
    ]
    for one in shown:
        between, facts = f"{quoted(one.a)} and {quoted(one.b)}", "; ".join(one.confidence.evidence)
        lines += comment(f"  {one.type}, score {one.confidence.score:.2f}, of {between}: {facts}")
        if one.type is not JointKind.FIXED and one.point is not None:
            lines += [f"#     origin: {alternative_origin(one.point, one.direction)}"]
    return lines


class TypicalDensity(NamedTuple):
    """A density and the material that it is typical of."""

    density: float
    """[kg/m^3]."""
    material: str


_TYPICAL: tuple[tuple[str, float, str], ...] = (
    (r"alumi\w*|\balu\b|\balmg\w*|\balsi\w*|\ben ?aw\b|\b[67]0\d\d\b|\b5052\b|\b5083\b|\b2024\b", 2700.0, "aluminium"),
    (r"cast ?iron|gusseisen|\bgjl\b|\bgjs\b", 7200.0, "cast iron"),
    (r"stainless|edelstahl|inox|\baisi ?3\d\d\b|\b1\.4\d{3}\b|\b(304|316|303)l?\b", 7900.0, "stainless steel"),
    (r"brass|messing|laiton|\bcuzn\w*", 8500.0, "brass"),
    (r"bronze|\bcusn\w*", 8800.0, "bronze"),
    (r"copper|kupfer|cuivre|\bcobre\b", 8940.0, "copper"),
    (r"titan\w*|\bti-?6al-?4v\b", 4430.0, "titanium"),
    (r"magnesi\w*|\baz91\w*", 1800.0, "magnesium"),
    (r"zinc|\bzink\b|zamak", 6700.0, "zinc"),
    (r"neodym\w*|\bndfeb\b|magnet", 7500.0, "neodymium magnet"),
    (r"steel|stahl|acier|\bacero\b|acciaio|\b1\.[0-3]\d{3}\b|\bs[23]\d\d\w*|\bc45\w*|\b42crmo4\b", 7850.0, "steel"),
    (r"carbon ?fib\w*|\bcfrp\b|\bcfk\b", 1600.0, "carbon fibre laminate"),
    (r"\bfr-?4\b|\bpcb\b|\bgrp\b|\bgfk\b|fib(er|re)glass", 1850.0, "glass fibre laminate"),
    (r"\babs\b|\basa\b", 1050.0, "ABS"),
    (r"\bpla\b|polylactic", 1240.0, "PLA"),
    (r"\bpetg?\b", 1270.0, "PETG"),
    (r"nylon|polyamid\w*|\bpa ?-?(6|11|12|66)\b|\bpa\b", 1130.0, "nylon"),
    (r"polycarbonat\w*|\bpc\b|lexan|makrolon", 1200.0, "polycarbonate"),
    (r"\bpom\b|delrin|acetal|polyoxymethyl\w*", 1410.0, "POM"),
    (r"acryl\w*|\bpmma\b|plexiglas\w*", 1190.0, "acrylic"),
    (r"\bptfe\b|teflon", 2200.0, "PTFE"),
    (r"\bpeek\b", 1310.0, "PEEK"),
    (r"\bpvc\b", 1400.0, "PVC"),
    (r"\b(hd|ld|uhmw)?-?pe\b|polyethyl\w*", 950.0, "polyethylene"),
    (r"\bpp\b|polypropyl\w*", 905.0, "polypropylene"),
    (r"\btpu\b|\btpe\b", 1200.0, "TPU"),
    (r"silicone?\b|silikon", 1150.0, "silicone rubber"),
    (r"rubber|gummi|\bnbr\b|\bepdm\b|neoprene?", 1200.0, "rubber"),
    (r"plywood|sperrholz", 650.0, "plywood"),
    (r"\bmdf\b", 750.0, "MDF"),
    (r"\bwood\b|\bholz\b|\boak\b|\bpine\b|\bbeech\b", 700.0, "wood"),
    (r"\bglass\b|\bglas\b", 2500.0, "glass"),
    (r"resin|epox\w*|\bsla\b", 1180.0, "resin"),
)  # fmt: skip
"""Patterns in the order in which they are tried: specific materials first."""
_PATTERNS = tuple((re.compile(pattern), TypicalDensity(density, name)) for pattern, density, name in _TYPICAL)


def typical_density(material: str) -> TypicalDensity | None:
    """The typical density of a material by its name; None without a known word."""
    name = re.sub(r"[_/(),;:]+", " ", material.casefold())
    return next((typical for pattern, typical in _PATTERNS if pattern.search(name)), None)


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
    kind = assembly.bodies[body].kind if body >= 0 else None
    return kind is BodyKind.SOLID or (kind is BodyKind.TESSELLATED and assembly.bodies[body].watertight)


def drawn_up(draft: Draft, assembly: Assembly) -> Standing | None:
    """Evidence that an axis other than z is up; None if there is none.

    Args:
        draft: A draft of the assembly.
        assembly: The assembly.
    """
    base = {draft.root}
    for joint in draft.joints:  # in tree order
        if joint.type is JointKind.FIXED and joint.parent in base:
            base.add(joint.child)
    parts = [index for link in draft.links if link.name in base for index in link.components]
    moving = [joint for joint in draft.joints if joint.parent in base and joint.child not in base]
    return standing(assembly, parts, [joint.direction for joint in moving if joint.direction is not None])
