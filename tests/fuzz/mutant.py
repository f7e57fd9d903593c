"""A mutant: a valid STEP file with one or several kinds of damage, reproducible from its name."""

from collections.abc import Callable, Sequence
from functools import cache
from itertools import cycle, product
from pathlib import Path
from random import Random

from msgspec import Struct

from .damage import flipped_bytes, spoiled_header, spoiled_strings, truncation
from .rewiring import circles, dropped_entities, numbers, rewired_references, spoiled_arguments, swapped_keywords
from .step_text import StepText

Damage = Callable[[StepText, Random], bytes]

KINDS: dict[str, Damage] = {
    "truncation": truncation,
    "bytes": flipped_bytes,
    "numbers": numbers,
    "entities": dropped_entities,
    "references": rewired_references,
    "circles": circles,
    "keywords": swapped_keywords,
    "arguments": spoiled_arguments,
    "strings": spoiled_strings,
    "header": spoiled_header,
}
MIXED = "mixed"
"""The kind of mutants with several kinds of damage."""
ALL_KINDS = (*KINDS, MIXED)


class Mutant(Struct, frozen=True):
    """The origin of a damaged file."""

    base: str
    """File name of the valid file."""
    kind: str
    """One of :data:`ALL_KINDS`."""
    seed: int
    number: int

    @property
    def name(self) -> str:
        """``base:kind:seed:number``."""
        return f"{self.base}:{self.kind}:{self.seed}:{self.number}"

    @property
    def file_name(self) -> str:
        """A file name that is valid on any system."""
        return f"{self.base.removesuffix('.step')}-{self.kind}-{self.seed}-{self.number}.step"

    @staticmethod
    def named(name: str) -> "Mutant":
        """The mutant of a name.

        Raises:
            ValueError: The name is not that of a mutant.
        """
        base, kind, seed, number = name.rsplit(":", 3)
        if kind not in ALL_KINDS:
            raise ValueError(f"no kind of damage is called '{kind}': {', '.join(ALL_KINDS)}")
        return Mutant(base, kind, int(seed), int(number))

    def content(self, bases: Path) -> bytes:
        """The damaged file; the bytes are deterministic."""
        # A text as seed gives the same numbers on every platform and for every hash seed.
        return damaged(step_text(bases / self.base), self.kind, Random(self.name))


def damaged(step: StepText, kind: str, rng: Random) -> bytes:
    """The bytes of a STEP file with damage of one of :data:`ALL_KINDS`."""
    if kind != MIXED:
        return KINDS[kind](step, rng)
    for _ in range(rng.choice((2, 3, 5))):
        step = StepText(KINDS[rng.choice(list(KINDS))](step, rng) or b" ")
    return step.data


def plan(bases: Sequence[str], count: int, seed: int) -> list[Mutant]:
    """``count`` mutants in which every pair of base and kind is equally frequent, in an order given by the seed."""
    pairs = list(product(bases, ALL_KINDS))
    Random(seed).shuffle(pairs)
    return [Mutant(*pair, seed, number) for number, pair in zip(range(count), cycle(pairs), strict=False)]


@cache
def step_text(path: Path) -> StepText:
    """The text of a valid STEP file."""
    return StepText(path.read_bytes())
