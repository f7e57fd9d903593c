"""The few questions that decide most of a draft: which link stands, and which pairs of parts move.

Equal pairs are one question: what is a hinge in one leg is one in the others. An answer is kept by the names of the
parts, so that it holds in the next revision of the CAD as well, and for further pairs of the same parts.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.draft.answers import STATED, Facts, KnownJoint, known_fixed, known_joint
from stepbot.draft.draft import Draft, DraftConnection, DraftLink, Option, Question
from stepbot.draft.draft_robot import Inference
from stepbot.draft.parts.names import Role, roles
from stepbot.geometry.fixed_point import exact_sum
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly
from stepbot.step.structure.naming import BODY, base_name

MOST = 5
"""Number of questions about one draft."""
STANDS = "stands"
"""Name of the question for the root."""
FIXED = JointKind.FIXED.value
_ALL = "all "
"""How names of questions about pairs of different parts start."""
_ROOTS = 5
"""Number of links that are offered as the root."""
_ROUNDS = 3
"""Times that links are inferred again for answers to questions that earlier answers raise."""
_ALIKE = 3
"""Number of groups from which those that are doubted for one reason are one question."""
_MOTIONS = {
    JointKind.REVOLUTE: "turn",
    JointKind.CONTINUOUS: "turn",
    JointKind.PRISMATIC: "slide",
    JointKind.CYLINDRICAL: "turn and slide",
}
_CARRIED = frozenset({Role.MOTOR, Role.FASTENER, Role.SEAL, Role.ELECTRIC})
"""Roles of parts that are held by others: a hole that one of them shares with its host is for a screw."""


class _Pair(Struct):
    """Two parts that may move, and the fact that each motion would be."""

    paths: tuple[str, str]
    drafted: str
    doubt: float
    """Probability that the draft is wrong, as far as its score states."""
    facts: dict[str, KnownJoint]
    review: str = ""
    """Why the draft doubts it."""


class _Group(Struct):
    """Pairs that one answer decides: all of the same two parts, or all that are doubted for one reason."""

    parts: tuple[str, str] | None
    """Names, the smaller part first; None for pairs of different parts."""
    pairs: list[_Pair] = field(default_factory=list)


class Dialogue:
    """A draft, the questions about it, and what is inferred from their answers."""

    def __init__(self, inference: Inference, assembly: Assembly) -> None:
        self._inference, self._assembly = inference, assembly
        self._index = {component.path: component.index for component in assembly.components}
        self._facts, self._answers = Facts(), dict[str, str]()
        self._decided: set[frozenset[str]] = set()
        """Pairs of paths that an answer was about."""
        self._plain = inference.draft()

    @property
    def draft(self) -> Draft:
        """The draft from all answers so far, with the questions that are left."""
        return replace(self._plain, answers=dict(self._answers), questions=tuple(self._questions()[:MOST]))

    def answer(self, name: str, value: str) -> bool:
        """Infer again with an answer; returns whether it is one of the options of an open question."""
        if not self._take(name, value):
            return False
        self._plain = self._inference.draft(self._facts)
        return True

    def answer_all(self, answers: Mapping[str, str]) -> None:
        """Infer again with all answers that apply; the others become notes of the draft."""
        # An answer about two parts overrides one about many.
        left = dict(sorted(answers.items(), key=lambda item: item[0].startswith(_ALL)))
        for _ in range(_ROUNDS):
            used = [name for name, value in left.items() if self._take(name, value)]
            if not used:
                break
            for name in used:
                del left[name]
            self._plain = self._inference.draft(self._facts)
        options = {question.name: [option.value for option in question.options] for question in self._questions()}
        notes = [
            f"the answer '{value}' to '{name}' was not used: "
            + (f"it must be one of {', '.join(options[name])}" if name in options else "there is no such question")
            for name, value in left.items()
        ]
        self._plain = replace(self._plain, notes=(*self._plain.notes, *notes))

    def _take(self, name: str, value: str) -> bool:
        """Add the facts of an answer; returns whether it answers an open question."""
        if name in self._answers:
            return False
        if name == STANDS:
            index = self._index.get(value, -1)
            if not any(index in link.components for link in self._plain.links):
                return False
            self._facts = replace(self._facts, root=index)
        else:
            group = {**self._alike(), **self._groups()}.get(name)
            pairs = [pair for pair in group.pairs if value in pair.facts] if group is not None else []
            pairs = [pair for pair in pairs if frozenset(pair.paths) not in self._decided]
            if not pairs:
                return False
            for pair in pairs:
                self._facts = self._facts.with_joint(pair.facts[value])
                self._decided.add(frozenset(pair.paths))
        self._answers[name] = value
        return True

    def _questions(self) -> list[Question]:
        """All open questions, those first that most joints depend on."""
        alike = self._alike()
        covered = {frozenset(pair.paths) for group in alike.values() for pair in group.pairs}
        asked = []
        for name, group in {**self._groups(), **alike}.items():
            pairs = [pair for pair in group.pairs if frozenset(pair.paths) not in self._decided]
            if name not in self._answers and pairs:
                is_part = name not in alike and all(frozenset(pair.paths) in covered for pair in pairs)
                doubt = exact_sum(pair.doubt for pair in pairs)
                asked.append(((is_part, -round(doubt, 9), name), _question(name, group.parts, pairs)))
        asked.sort(key=lambda one: one[0])
        root = self._root_question()
        return [*([root] if root is not None else []), *(question for _, question in asked)]

    def _root_question(self) -> Question | None:
        """Which link stands: asked unless the root is named a base."""
        draft = self._plain
        branches = defaultdict[str, int](int)
        for joint in draft.joints:
            branches[joint.parent] += 1
            branches[joint.child] += 1
        root = next(link for link in draft.links if link.name == draft.root)
        if len(draft.links) < 2 or STANDS in self._answers or Role.BASE in roles(root.drawn or root.name):
            return None
        others = [link for link in draft.links if link is not root and link.components]
        others.sort(key=lambda link: (-branches[link.name], -exact_sum(map(self._volume, link.components)), link.name))
        return Question(
            STANDS,
            "Which link stands, as the root?",
            tuple(self._root_option(link, is_drafted=link is root) for link in [root, *others][:_ROOTS]),
            len(draft.joints),
        )

    def _root_option(self, link: DraftLink, *, is_drafted: bool) -> Option:
        largest = max(link.components, key=lambda i: (self._volume(i), -i), default=0)
        return Option(self._assembly.components[largest].path, link.name, is_drafted=is_drafted)

    def _groups(self) -> dict[str, _Group]:
        """Pairs that may move or be fixed, by the names of their parts."""
        groups: dict[tuple[str, str, str], _Group] = {}
        for motion, pair in self._pairs():
            small, large = sorted(pair.paths, key=lambda path: (self._volume(self._index[path]), path))
            names = self._name(small), self._name(large)
            first, second = sorted(names)
            groups.setdefault((first, second, motion), _Group(names)).pairs.append(pair)
        named: dict[str, _Group] = {}
        for (a, b, motion), group in sorted(groups.items()):
            plain = f"{a} + {b}"
            named[f"{plain} ({motion})" if plain in named else plain] = group
        return named

    def _alike(self) -> dict[str, _Group]:
        """Pairs of several parts that the draft doubts for one reason: they are a linkage, or they are clamped."""
        groups: dict[tuple[str, str], list[_Group]] = defaultdict(list)
        for group in self._groups().values():
            first = group.pairs[0]
            if first.review and first.drafted != FIXED:
                groups[first.drafted, first.review].append(group)
        return {
            f"{_ALL}{motion}: {review}": _Group(None, [pair for group in several for pair in group.pairs])
            for (motion, review), several in sorted(groups.items())
            if len(several) >= _ALIKE
        }

    def _pairs(self) -> list[tuple[str, _Pair]]:
        """Each pair with its motion."""
        pairs = []
        for joint in (*self._plain.joints, *self._plain.closures):
            if joint.is_open and joint.type is not JointKind.FIXED and not _is_stated(joint):
                facts, score = _facts_of_connection(joint), joint.confidence.score
                is_drafted = joint.confidence.is_chosen
                drafted = joint.type.value if is_drafted else FIXED
                doubt = 1.0 - score if is_drafted else score
                pairs.append((joint.type.value, _Pair(joint.parts, drafted, doubt, facts, joint.review)))
        for one in self._plain.fused:
            if one.point is None or _CARRIED & {role for path in (one.a, one.b) for role in roles(self._name(path))}:
                continue
            motion = one.type.value
            why = "; ".join((STATED, *one.confidence.evidence))
            moves = KnownJoint(one.a, one.b, one.type, one.point, one.direction, None, why)
            still = KnownJoint(one.a, one.b, JointKind.FIXED, one.point, None)
            pair = _Pair((one.a, one.b), FIXED, one.confidence.score, {FIXED: still, motion: moves})
            pairs.append((motion, pair))
        return pairs

    def _volume(self, index: int) -> float:
        body = self._assembly.components[index].body
        exact = self._assembly.bodies[body].exact if body >= 0 else None
        return exact.volume if exact is not None else 0.0

    def _name(self, path: str) -> str:
        """The name of a part in questions, the same for all equal ones: of a body of several, with that of its part."""
        component = self._assembly.components[self._index[path]]
        name = base_name(component.product, component.occurrence)
        if name != BODY:
            return name
        if component.parent <= 0:
            return component.segment
        above = self._assembly.components[component.parent]
        return f"{base_name(above.product, above.occurrence)}/{component.segment}"


def _is_stated(joint: DraftConnection) -> bool:
    return any(fact.startswith(STATED) for fact in joint.confidence.evidence[:1])


def _facts_of_connection(joint: DraftConnection) -> dict[str, KnownJoint]:
    """The fact that each answer about a drafted joint is, the drafted one first."""
    facts = {joint.type.value: known_joint(joint)}
    for other in joint.alternatives:
        if other.point is not None or other.type == joint.type:
            facts.setdefault(other.type.value, known_joint(joint, other))
    facts.setdefault(FIXED, known_fixed(joint))
    return facts


def _question(name: str, parts: tuple[str, str] | None, pairs: Sequence[_Pair]) -> Question:
    drafted = pairs[0].drafted
    values = dict.fromkeys([drafted, *(value for pair in pairs for value in pair.facts if value != FIXED), FIXED])
    motion = next((_MOTIONS.get(JointKind(value), "move") for value in values if value != FIXED), "move")
    if parts is None:
        text = f"{len(pairs)} pairs of parts: {pairs[0].review}. Do they {motion} on each other, or are they fixed?"
    elif len(pairs) == 1:
        text = f"Does '{parts[0]}' {motion} on '{parts[1]}', or is it fixed?"
    else:
        text = (
            f"Do '{parts[0]}' and '{parts[1]}' {motion} on each other, in all {len(pairs)} places, or are they fixed?"
        )
    options = tuple(Option(value, value, is_drafted=value == drafted) for value in values)
    return Question(name, text, options, len(pairs))
