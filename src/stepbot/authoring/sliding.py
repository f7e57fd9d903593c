"""Revolute or prismatic: a shaft in a bore without a shoulder allows both.

Decided by a loop, else by shape and name.
"""

from collections.abc import Sequence

from stepbot.robot.model import JointKind

from .loops import Arc, loop_motions
from .survey import Survey

_WORDS = ("piston", "slide", "rod", "cylinder", "telescop", "prismatic", "linear", "quill", "carriage")
_SLIM = 3.0
"""Engaged length in radii from which a shaft may be prismatic."""


def choose_slides(survey: Survey, arcs: Sequence[Arc]) -> None:
    """Make joints prismatic if only that motion is possible, or if they are named so."""
    motions = loop_motions(arcs)
    for k, arc in enumerate(arcs):
        if not arc.could_slide:
            continue
        h, r = arc.hinge, arc.hinge.relation
        assert r is not None
        paths = " ".join(survey.parts[i].path.lower() for i in (h.a, h.b)) if survey.sources.names else ""
        called_so = r.length > _SLIM * r.radius and any(word in paths for word in _WORDS)
        motion = motions.get(k)
        if motion is not None and motion.slides and not motion.turns:
            h.type, h.review = JointKind.PRISMATIC, "the loop can move only if it is prismatic"
        elif called_so and (motion is None or motion.slides):
            h.type, h.review = JointKind.PRISMATIC, "could also be revolute"
