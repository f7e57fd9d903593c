"""``stepbot motors``: list and show the motors of the catalogue, each figure with its source."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .columns import table_lines
from .command import PATH, Command, json_option
from .terminal import screen_width, show_diagnostics, write_document, write_json, write_result

if TYPE_CHECKING:
    from stepbot.sidecar.motor_sections import MotorSection

_EFFORTS = ("stall_torque", "peak_torque", "holding_torque", "rated_torque", "max_force")
_SPEEDS = ("no_load_speed", "rated_speed", "no_load_linear_speed")
"""Figures in a list, the first that is known."""


@click.command(cls=Command, epilog="Example: stepbot motors XL430-W250")
@click.argument("name", required=False)
@click.option("--own", type=PATH, metavar="FILE", help="A file of motors of your own; they come first.")
@json_option
def command(name: str | None, own: Path | None, as_json: bool) -> int:
    """List the motors that `motor:` of an actuator can name, or show NAME: each figure with its source, and doubts.

    A name of a family shows all its members.
    """
    from stepbot.diagnostics import Diagnostics
    from stepbot.sidecar.fitting import read_own_motors
    from stepbot.sidecar.motors import catalogue_motor, catalogue_names

    diagnostics = Diagnostics()
    mine = read_own_motors(own, diagnostics) if own is not None else {}
    if mine is None or diagnostics.has_errors:
        if as_json:
            return write_document({"motors": {}}, diagnostics)
        show_diagnostics(diagnostics)
        return diagnostics.exit_code
    if name is None:
        shown = {**mine, **{one: catalogue_motor(one) for one in catalogue_names() if one not in mine}}
    else:
        shown = _chosen(name, mine)
    if as_json:
        write_json({"motors": {one: motor.model_dump(mode="json", exclude_none=True) for one, motor in shown.items()}})
    elif name is None:
        rows = [_row(one, motor) for one, motor in shown.items()]
        write_result("\n".join(table_lines(rows, screen_width(sys.stdout))))
    else:
        write_result("\n\n".join("\n".join(_lines(one, motor)) for one, motor in shown.items()))
    return 0


def _chosen(name: str, mine: "dict[str, MotorSection]") -> "dict[str, MotorSection]":
    """The motor of a name, or the members of a family."""
    from stepbot.sidecar.motors import AmbiguousMotor, UnknownMotor, find_motor

    try:
        return dict([find_motor(name, mine)])
    except AmbiguousMotor as family:
        return dict(find_motor(member, mine) for member in family.members)
    except UnknownMotor as unknown:
        near = f"did you mean {' or '.join(unknown.nearest)}?" if unknown.nearest else "`stepbot motors` lists all"
        raise click.BadParameter(f"{unknown}; {near}", param_hint="NAME") from None


def _row(name: str, motor: "MotorSection") -> tuple[str, ...]:
    figures = motor.figures()
    effort, speed = (next((field for field in fields if field in figures), "") for fields in (_EFFORTS, _SPEEDS))
    cells = [f"{figures[one].value:.4g} {motor.unit_of(one)}" if one else "-" for one in (effort, speed)]
    supply = f"{figures['voltage'].value:g} V" if "voltage" in figures else "-"
    return (name, motor.maker or "", motor.kind.value.replace("_", " "), supply, *cells)


def _lines(name: str, motor: "MotorSection") -> list[str]:
    """All that is known of a motor."""
    width = screen_width(sys.stdout)
    lines = [f"{name}: {motor.kind.value.replace('_', ' ')}{f' of {motor.maker}' if motor.maker else ''}"]
    if motor.names:
        lines.append(f"also: {', '.join(motor.names)}")
    if motor.family:
        lines.append(f"family, which several motors share: {', '.join(motor.family)}")
    rows = [
        (key, f"{_text(one.value)} {motor.unit_of(key)}{f' at {one.voltage:g} V' if one.voltage else ''}", one.source)
        for key, one in motor.figures().items()
    ]
    for at in motor.at_other_voltages:
        rows += [
            (f"{key} at {at.voltage:g} V", f"{_text(one.value)} {motor.unit_of(key)}", at.source or motor.source or "")
            for key in ("stall_torque", "no_load_speed", "rated_speed")
            if (one := getattr(at, key)) is not None
        ]
    lines += ["", *table_lines(rows, width)]
    if motor.alternatives:
        others = [
            (alternative.field, f"{_text(alternative.value)} {motor.unit_of(alternative.field)}", alternative.source)
            for alternative in motor.alternatives
        ]
        lines += ["", "other sources, which are never filled in:", *table_lines(others, width)]
    lines += [f"doubt: {key.replace('_', ' ')}: {text}" for key, text in motor.doubts.items()]
    return [*lines, *([f"note: {motor.note}"] if motor.note else [])]


def _text(value: object) -> str:
    if isinstance(value, tuple | list):
        return ", ".join(map(_text, value))
    return f"{value:.6g}" if isinstance(value, int | float) else str(value)
