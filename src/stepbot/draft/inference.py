"""Infers links, joints and closures from an assembly, to draft a sidecar."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.draft.answers import NO_FACTS, Facts, fact_evidence
from stepbot.draft.contacts.relations import Via
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.draft import CHOSEN
from stepbot.draft.evidence import rules
from stepbot.draft.evidence.evidence import ONLY_CONNECTION, Evidence, JointEvidence, Verdict, Weld
from stepbot.draft.evidence.gears import mark_geared
from stepbot.draft.evidence.motors import Motor, find_motors
from stepbot.draft.evidence.repetition import repeated_joints
from stepbot.draft.evidence.subassemblies import Structure
from stepbot.draft.mechanism import locked
from stepbot.draft.mechanism.decide import Decision, adopt, decide
from stepbot.draft.mechanism.gaps import tie_by_seams
from stepbot.draft.mechanism.joints import Mechanism
from stepbot.draft.mechanism.locked import (
    JointKey,
    choose_slides,
    held_joints,
    hold,
    missing_joints,
    note_doubts,
    one_per_pair,
    promote,
    slide_in_struts,
    stop_spinning_rods,
)
from stepbot.draft.mechanism.loops import TreeJoint, locked_arcs, spanning_tree
from stepbot.draft.mechanism.round_contacts import lone_pivots
from stepbot.draft.mechanism.unconnected import LooseEnds, find_root
from stepbot.draft.parts.axis import SAME_LINE
from stepbot.step.assembly import Assembly

_FEWEST_TRIES, _TRIED_PARTS = 3, 4000
"""Joints that are tried in loops that cannot move: at least, and the parts of all tries together."""
_MOST_HELD = 6
"""Number of times that joints which are none are left out: others may be the last ones then."""


class InferredMechanism(Struct, frozen=True, eq=False):
    """Links by number, and the joints between them."""

    survey: Survey
    links: list[list[int]]
    """Parts of each link, ascending; links in the order of their first parts."""
    root: int
    arcs: list[TreeJoint]
    """Joints in tree order, then closures."""
    offered: list[JointEvidence]
    """Joints that were found but not accepted, the strongest first."""
    motors: list[Motor]
    guesses: dict[int, str]
    """Reasons for guessed assignments of parts."""
    welds: Sequence[Weld] = ()
    """Evidence that two parts move as one, as far as it was used."""
    pivots: Mapping[JointKey, str] = field(default_factory=dict)
    """Joints within links where only one round contact holds two sides together, and what to review of each."""


def infer_mechanism(assembly: Assembly, sources: Sources = ALL_SOURCES, facts: Facts = NO_FACTS) -> InferredMechanism:
    """Infer links and joints; ``assembly`` must be read with its faces (``ReadOptions.faces``)."""
    return infer_from(Survey.settled(assembly, sources), facts)


def infer_from(survey: Survey, facts: Facts = NO_FACTS) -> InferredMechanism:
    """Infer links and joints.

    Raises:
        KeyError: A fact is about a path that is not that of a part.
    """
    inferred = _infer(survey, facts, {})
    needed = dict(inferred.pivots)
    # Joints that equal parts elsewhere show.
    joints = [arc.evidence for arc in inferred.arcs if arc.evidence.score >= CHOSEN]
    repeats = repeated_joints(inferred.survey, joints, inferred.links)
    if needed or repeats:
        inferred = _infer(survey, facts, needed, repeats)
    held: dict[JointKey, str] = {}
    for _ in range(_MOST_HELD):
        if not (more := held_joints(inferred.survey, inferred.arcs, inferred.links, inferred.offered)):
            break
        held |= more
        inferred = _infer(survey, facts, needed, repeats, held)
    # Each try infers everything again: the work is bounded by the number of parts.
    left = max(_FEWEST_TRIES, _TRIED_PARTS // max(1, len(survey.parts)))
    while stuck := locked_arcs(inferred.arcs):
        for key in missing_joints(inferred.arcs, inferred.offered, inferred.links, stuck)[:left]:
            left -= 1
            tried = _infer(survey, facts, {**needed, key: locked.REVIEW}, repeats, held)
            if len(locked_arcs(tried.arcs)) < len(stuck):
                needed[key] = locked.REVIEW
                inferred = tried
                break
        else:
            break
    return inferred


def _infer(
    survey: Survey,
    facts: Facts,
    needed: Mapping[JointKey, str],
    repeats: Sequence[JointEvidence] = (),
    held: Mapping[JointKey, str] = MappingProxyType({}),
) -> InferredMechanism:
    motors, evidence = find_motors(survey), Evidence()
    fact_evidence(survey, facts, evidence)
    given: dict[str, Any] = {"survey": survey, "motors": motors, "evidence": evidence}
    for find, names in rules():
        if "structure" in names and "structure" not in given:
            given["structure"] = Structure(survey, evidence.mechanisms)
        find(**{name: given[name] for name in names})
    structure: Structure = given["structure"]
    for hinge in repeats:
        evidence.joint(replace(hinge))
    promote(evidence, {key: review for key, review in needed.items() if key not in held})
    hold(evidence, held)
    made = decide(survey, motors, evidence)
    pivots = lone_pivots(made, structure)
    tie_by_seams(made)
    adopt(made, structure)
    return replace(_arranged(made, structure, motors, facts), pivots=pivots)


def _arranged(decision: Decision, structure: Structure, motors: list[Motor], facts: Facts) -> InferredMechanism:
    mechanism = Mechanism(decision, structure)
    if facts.root in decision.clusters:
        root = decision.clusters.find(facts.root)
    else:
        root = find_root(decision, structure, mechanism.joints, motors)
    mark_geared(
        decision.survey,
        [(j.evidence, decision.clusters.members(j.a), decision.clusters.members(j.b)) for j in mechanism.joints],
    )
    slide_in_struts(mechanism.joints)
    stop_spinning_rods(mechanism.joints, root)
    LooseEnds(decision, mechanism, structure).tie(root)
    groups = decision.clusters.groups()
    number = {cluster: n for n, cluster in enumerate(groups)}
    joints = one_per_pair([j for j in mechanism.joints if j.a != j.b])
    arcs = spanning_tree(joints, number, number[decision.clusters.find(root)])
    choose_slides(arcs)
    note_doubts(arcs, structure, lambda i: number[decision.clusters.find(i)], has_drives=bool(motors))
    largest = {
        root: max(members, key=lambda i: (decision.survey.parts[i].volume, -i)) for root, members in groups.items()
    }
    used = {id(arc.evidence) for arc in arcs}
    offered = [h for h in mechanism.offered if id(h) not in used]
    for arc in arcs:
        h = arc.evidence
        if h.score < CHOSEN:
            h.review = h.review or ONLY_CONNECTION
            # Sides that end beside each other about one axis turn; a face on a face may be a foot.
            h.score = CHOSEN if h.relation is not None and h.relation.via == Via.SEAM else h.score
        # The axis may be that of a motor, whose output is drawn off what it carries.
        off = decision.survey.drawn_off(
            [h.a, h.b, *(largest[decision.clusters.find(i)] for i in (h.a, h.b))], h.axis.point
        )
        if off > SAME_LINE:
            apart = f"its sides are drawn {1e3 * off:.2g} mm off each other"
            h.review = f"{h.review}; {apart}" if h.review else apart
    links = list(groups.values())
    welds = [weld for weld in decision.evidence.welds if weld.verdict is Verdict.TAKEN]
    return InferredMechanism(
        decision.survey, links, number[decision.clusters.find(root)], arcs, offered, motors, decision.guesses, welds
    )
