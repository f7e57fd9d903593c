"""Drafts of drawn mechanisms as they were recorded: what a rule changes is seen in each of them."""

import re
from functools import cache
from pathlib import Path

from stepbot.draft.draft_robot import infer
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.step.assembly import Assembly

from .scored import drawn

RECORDED = Path(__file__).with_name("drafts.txt")
DRAFTED = (
    ("wheeled", 0),  # four wheels of rim and tyre, motors in clamps
    ("wheeled", 3),  # the same without names
    ("slider_crank", 0),  # a piston between guides, a pin that stands on the base
    ("slider_crank", 5),
    ("gear_gripper", 0),  # one half is like the other, mirrored
    ("quadruped", 0),  # one leg is placed 0.36 mm off
    ("telescope", 0),
    ("telescope", 1),  # with clearance
    ("profile_rail", 0),
    ("walker", 0),
    ("hinged_lid", 0),
    ("excavator", 0),  # a cylinder that slides in a loop
    ("forked_wheels", 2),  # wheels between the cheeks of forks, in Spanish
    ("forked_wheels", 3),  # forks and wheels of casters in subassemblies
    ("turntable", 0),  # two rings of one bearing, each bolted to something else
    ("turntable", 2),  # a column off the axis of a round table
    ("side_by_side", 2),  # three fingers on one pin
    ("side_by_side", 4),  # pins with the clearance of a screw's hole
    ("neck", 3),  # balls in a chain
    ("rocker_bogie", 1),
    ("drawers", 2),  # profiles in profiles, with play to the sides
    ("stage", 0),  # blocks without clearance in one subassembly with their rail, and a screw in a nut
    ("corexy", 2),  # blocks on rails in imports, each with parts of several links
    ("rack_gripper", 0),
    ("dovetail_stage", 1),  # flanks that are not across each other
    ("knee_brace", 1),  # clevis pins with washers and circlips
    ("coaxial_legs", 0),  # a thigh between two actuators on one line, each a disc in the end of a housing
    ("coaxial_legs", 1),  # flanges turned less than what they carry, so that their holes are not in line
    ("hub_drive", 5),  # casters: wheels on axles of their own, forks that trail
)
"""Kinds and seeds whose joints are all found."""


def draft_text(assembly: Assembly, kind: str) -> str:
    """The draft as `stepbot init` writes it, without stops and densities."""
    return sidecar_text(infer(assembly, kind), f"{kind}.step")


@cache
def recorded() -> dict[str, str]:
    """The recorded drafts, by kind and seed."""
    parts = re.split(r"^==== (.*)\n", RECORDED.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    return dict(zip(parts[::2], parts[1::2], strict=True))


def record() -> None:
    """Record the drafts as they are."""
    texts = {f"{kind} {seed}": draft_text(drawn(kind, seed).assembly()[0], kind) for kind, seed in DRAFTED}
    whole = "".join(f"==== {name}\n{text}" for name, text in texts.items())
    RECORDED.write_text(whole, encoding="utf-8", newline="\n")
