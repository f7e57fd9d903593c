"""Check that the units of joints' values match the types of the joints: SB138, once for each cause."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import JointKind

from .joint_settings import joint_settings, position_dimension, settings_of
from .located import Sidecar
from .subjects import subject
from .tree import Keys
from .units import ANGLE, LENGTH, PITCH, RATIO, TURNS, Dimension

_SUSPICIOUS = 3
"""Number of values of one joint that suggest that its type is wrong, if no unit of a value matches it."""


_RATIOS: dict[tuple[Dimension | None, Dimension | None], Dimension] = {(LENGTH, ANGLE): PITCH, (ANGLE, LENGTH): TURNS}
"""Dimension of a multiplier by those of the following and the leading joint, where they differ."""


class _Unit(NamedTuple):
    """The unit of one value of a joint."""

    joint: str
    kind: JointKind
    keys: Keys
    """Of the joint or of one of its defaults."""
    written: Dimension
    needed: Dimension

    @property
    def is_wrong(self) -> bool:
        return self.written != self.needed


def check_joint_units(sidecar: Sidecar, found: Diagnostics) -> None:
    """Report SB138: one for a joint of a wrong type, one for a default of several joints, else one for each value."""
    shared: dict[Keys, list[_Unit]] = {}
    for name in sidecar.document.joints:
        units = list(_units(sidecar, name))
        own = [unit for unit in units if unit.keys[0] == "joints"]
        wrong = [unit for unit in own if unit.is_wrong]
        if len(wrong) == len(own) >= _SUSPICIOUS:
            _report_type(sidecar, wrong, found)
        else:
            for unit in wrong:
                check_unit(sidecar, f"joint '{name}'", unit.kind, unit.written, unit.needed, unit.keys, found)
        for unit in units:
            if unit.is_wrong and unit.keys[0] != "joints":
                shared.setdefault(unit.keys, []).append(unit)
    for several in shared.values():
        _report_default(sidecar, several, found)


def _units(sidecar: Sidecar, name: str) -> Iterator[_Unit]:
    """The values of a joint, its defaults included, that have a unit."""
    joint = sidecar.document.joints[name]
    known, position = settings_of(joint.type), position_dimension(joint.type)
    for field, setting in joint_settings(sidecar.document, name).items():
        if field in known and setting.dimension is not None:
            yield _Unit(name, joint.type, setting.keys, setting.dimension, known[field])
    if position is None:
        return
    if joint.zero.dimension is not None:
        yield _Unit(name, joint.type, ("joints", name, "zero"), joint.zero.dimension, position)
    if joint.mimic is not None and joint.mimic.offset.dimension is not None:
        yield _Unit(name, joint.type, ("joints", name, "mimic", "offset"), joint.mimic.offset.dimension, position)
    leader = joint.mimic and sidecar.document.joints.get(joint.mimic.joint)
    if joint.mimic is not None and joint.mimic.multiplier.dimension is not None and leader:
        needed = _RATIOS.get((position, position_dimension(leader.type)), RATIO)
        yield _Unit(name, joint.type, ("joints", name, "mimic", "multiplier"), joint.mimic.multiplier.dimension, needed)


def _report_type(sidecar: Sidecar, wrong: Sequence[_Unit], found: Diagnostics) -> None:
    name, kind = wrong[0].joint, wrong[0].kind
    message = f"joint '{name}': the units of {len(wrong)} values do not match its type {kind}"
    notes = [
        f"line {sidecar.span(*unit.keys).line}: {unit.keys[-1]}: '{sidecar.written(*unit.keys)}' is not "
        f"{_a(unit.needed)} [{unit.needed.unit}]"
        for unit in wrong
    ]
    types = [
        other
        for other in (JointKind.REVOLUTE, JointKind.PRISMATIC)
        if all(unit.written in (*settings_of(other).values(), position_dimension(other)) for unit in wrong)
    ]
    help = [f"change the type to {' or '.join(types)}, or correct the values"] if types else ["correct the values"]
    found.add("SB138", message, sidecar.span("joints", name, "type"), help=help, notes=notes)


def _report_default(sidecar: Sidecar, several: Sequence[_Unit], found: Diagnostics) -> None:
    first = several[0]
    if len(several) == 1:
        who = f"joint '{first.joint}'"
        check_unit(sidecar, who, first.kind, first.written, first.needed, first.keys, found)
        return
    kinds = " and ".join(dict.fromkeys(unit.kind for unit in several))
    needed = " or ".join(dict.fromkeys(f"{_a(unit.needed)} [{unit.needed.unit}]" for unit in several))
    key = first.keys[-1]
    message = f"{subject(first.keys[:2])}: {key}: '{sidecar.written(*first.keys)}' is not {needed}, required for "
    names = ", ".join(f"'{unit.joint}'" for unit in several)
    found.add(
        "SB138",
        f"{message}{len(several)} {kinds} joints",
        sidecar.span(*first.keys),
        help=[f"set `{key}` on these joints themselves, or in a default of their own above this one"],
        notes=[f"joints: {names}"],
    )


def check_unit(
    sidecar: Sidecar,
    who: str,
    kind: JointKind,
    written: Dimension | None,
    needed: Dimension,
    keys: Keys,
    found: Diagnostics,
) -> None:
    """Report SB138 if the unit of a value does not match the joint type."""
    if written is None or written == needed:
        return
    key = keys[-1] if keys[0] != "joint_defaults" else f"{keys[-1]} of {subject(keys[:2])}"
    written_as = sidecar.written(*keys)
    message = f"{who}: {key}: '{written_as}' is not {_a(needed)} [{needed.unit}], required for a {kind} joint"
    help = [f"example: {needed.example}"]
    if keys[0] == "joint_defaults":
        help.append(f"or set `{keys[-1]}` on {who} itself")
    found.add("SB138", message, sidecar.span(*keys), help=help)


def _a(dimension: Dimension) -> str:
    return f"{'an' if dimension.name[0] in 'aeiou' else 'a'} {dimension.name}"
