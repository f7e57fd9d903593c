"""Drafts a sidecar from a STEP file: with the joints stated in the file, else joints inferred from its shapes."""

from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from stepbot.authoring.densities_of import equal_density, without_density
from stepbot.authoring.draft import Draft
from stepbot.authoring.infer import infer
from stepbot.authoring.stated_joints import draft_of_mechanism
from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.robot.step_names import step_stem
from stepbot.step.assembly import ReadOptions
from stepbot.step.exchange.mechanisms import Mechanism, read_mechanism
from stepbot.step.exchange.part21 import check_step

from .conversion import Options
from .loading import Loading


@dataclass(frozen=True, eq=False)
class Drafting:
    """The draft of a STEP file."""

    diagnostics: Diagnostics
    draft: Draft | None = None
    """None after errors."""
    stated: bool = False
    """Whether the joints are kinematic pairs of the file."""


def draft_step(step: Path, options: Options) -> Drafting:
    """Read a STEP file and draft links and joints; writes nothing.

    Args:
        step: The STEP file.
        options: Code page, limits and cache.
    """
    found = Diagnostics()
    try:
        what = ReadOptions(encoding=options.encoding, faces=True)
        with closing(Loading(step, what, options, found)) as loading:
            assembly = loading.assembly(found)
            mechanism = _mechanism(step, options)
        found.raise_if_errors()
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Drafting(found)
    stated = draft_of_mechanism(mechanism, assembly, step_stem(step.name)) if mechanism is not None else None
    draft = stated or infer(assembly, step_stem(step.name))
    if mechanism is not None and stated is None:
        note = "the STEP file has kinematic pairs between unknown components; they were ignored"
        draft = replace(draft, notes=(*draft.notes, note))
    draft = replace(draft, without_density=without_density(assembly), equal_density=equal_density(assembly))
    return Drafting(found, draft, stated is not None)


def _mechanism(step: Path, options: Options) -> Mechanism | None:
    """The kinematic pairs in a file that was read."""
    part21 = check_step(step, str(step), Diagnostics(), options.encoding)
    return read_mechanism(step, part21.encoding) if part21 is not None else None
