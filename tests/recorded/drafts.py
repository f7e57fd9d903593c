"""Drafts of drawn mechanisms with their evidence: as drawn, by geometry alone, with parts nudged, by a description."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from random import Random

from msgspec.structs import replace

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources
from stepbot.draft.draft_robot import Inference, infer
from stepbot.draft.from_description.drafted import draft_of_description
from stepbot.draft.inference import infer_mechanism
from stepbot.draft.questions import Dialogue
from stepbot.draft.stops.stops import with_stops
from stepbot.draft.text.sidecar_text import drawn_up, sidecar_text, without_density
from stepbot.draft.touching import contacts_of
from stepbot.geometry.spatial import Pose, vector3
from stepbot.sidecar.load import parse_sidecar
from stepbot.step.assembly import Assembly
from tests.assembled import BARE
from tests.made.described import description_of
from tests.made.kinds import ASIDE, ASIDE_BOUGHT, ASIDE_LATER, ASIDE_LATEST, KINDS
from tests.made.scored import drawn

_SLOW = {"gear_gripper": 1, "coaxial_legs": 1, "rack_gripper": 1, "servo_arm": 1, "harmonic_arm": 1, "corexy": 1}
"""Kinds that take more than a second to draw, and how many of each are drawn."""
_SEEDS = 2
_NUDGES = (2e-5, 2e-4, 6e-4)
"""How far parts are off their places [m], about: within clearances, at their bounds, and beyond."""


def _nudged(assembly: Assembly, random: Random, scales: Sequence[float], share: float) -> Assembly:
    """An assembly with a share of the parts off their places by about so much [m]."""

    def moved(X: Pose) -> Pose:
        scale = random.choice(scales)
        return Pose(X.rotation, vector3(X.p + [random.gauss(0.0, scale) for _ in range(3)]))

    parts = (replace(one, X_WC=moved(one.X_WC)) if random.random() < share else one for one in assembly.components)
    return replace(assembly, components=tuple(parts))


def _drafted(assembly: Assembly, sources: Sources = ALL_SOURCES) -> tuple[str, object]:
    """The sidecar as `stepbot init` writes it, and the evidence for and against it."""
    draft = with_stops(infer(assembly, "drawn", sources), assembly)
    draft = replace(draft, standing=drawn_up(draft, assembly))
    draft = replace(draft, contacts=contacts_of(draft, assembly), without_density=without_density(assembly))
    return sidecar_text(draft, "drawn.step"), replace(infer_mechanism(assembly, sources), survey=())


def _answered(assembly: Assembly, random: Random) -> object:
    """The questions about a draft, and the draft after one has been answered, with one answer that fits none."""
    dialogue = Dialogue(Inference(assembly, "drawn"), assembly)
    asked = dialogue.draft.questions
    if asked:
        one = random.choice(asked)
        dialogue.answer_all({one.name: random.choice(one.options).value, "nobody": "revolute"})
    return asked, sidecar_text(dialogue.draft, "drawn.step")


def _built(assembly: Assembly, text: str) -> object:
    """The robot of a draft, and what is reported of it; of drawn meshes the exact bodies count as measured."""
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("drawn.robot.yaml"), diagnostics)
    assert sidecar is not None, list(diagnostics)
    built = build_robot(assembly, sidecar, lambda: [body.exact for body in assembly.bodies], diagnostics)
    if built is not None:
        built.double_counting.report(60.0)
    return [str(one) for one in diagnostics], built and (built.robot, built.joint_table)


def _results_of(kind: str, seed: int, noise: float) -> dict[str, object]:
    kit, random = drawn(kind, seed), Random(f"{kind} {seed}")
    assembly, link_of = kit.assembly(is_meshed=True)
    assembly = _nudged(assembly, Random(1), [noise], 1.0) if noise else assembly

    def described(shown: float) -> object:
        """The draft `--from` a description, some of whose links have no shapes."""
        description = description_of(kit, assembly, link_of, random, shown=shown)[0]
        return draft_of_description(description, assembly, "drawn", "drawn.urdf")

    text, evidence = _drafted(assembly)
    return {
        "drawn": (text, evidence),
        "built": _built(assembly, text),
        "bare": _drafted(assembly, BARE),
        "nudged": _drafted(_nudged(assembly, random, _NUDGES, 1 / 3)),
        "answered": _answered(assembly, random),
        "described": described(1.0),
        "half": described(0.6),
    }


RESULTS = {
    f"{kind} {seed}": partial(_results_of, kind, seed)
    for kind in KINDS
    if kind not in ASIDE | ASIDE_BOUGHT | ASIDE_LATER | ASIDE_LATEST
    for seed in range(_SLOW.get(kind, _SEEDS))
}
