"""Drafts a sidecar from a STEP file: with joints from a description or stated in the file, else inferred ones."""

from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span, StepbotError
from stepbot.draft.draft import Draft
from stepbot.draft.draft_robot import Inference
from stepbot.draft.from_description.drafted import draft_of_description
from stepbot.draft.named_joints import draft_of_names
from stepbot.draft.questions import Dialogue
from stepbot.draft.stated_joints import draft_of_mechanism
from stepbot.draft.stops.stops import with_stops
from stepbot.draft.text.sidecar_text import (
    SCHEMA_FILE,
    drawn_up,
    equal_density,
    relative_step,
    sidecar_text,
    without_density,
)
from stepbot.draft.touching import contacts_of
from stepbot.robot.step_names import step_stem
from stepbot.runtime.file import exists, write_file
from stepbot.sidecar.load import load_sidecar
from stepbot.sidecar.schema import schema_text
from stepbot.step.assembly import Assembly, MeshTolerance, ReadOptions
from stepbot.step.exchange.mechanisms import Mechanism, has_mechanism, read_mechanism
from stepbot.step.exchange.part21 import check_step

from .building import report_size
from .conversion import Options
from .describing import read_description
from .loading import Loading

_COARSE = MeshTolerance(relative=0.05, angle=0.8)
"""Inference reads exact faces; of the meshes it needs corners and approximate volumes."""


class Drafting(Struct, frozen=True, eq=False):
    """The draft of a STEP file."""

    diagnostics: Diagnostics
    draft: Draft | None = None
    """None after errors."""
    stated: bool = False
    """Whether the joints are kinematic pairs of the file."""


Ask = Callable[[Draft, Dialogue | None], Draft]
"""Returns a draft corrected by the user; without questions to answer if its joints are not inferred."""


def draft_step(
    step: Path,
    options: Options,
    description: Path | None = None,
    ask: Ask | None = None,
    answers: Mapping[str, str] | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> Drafting:
    """Read a STEP file and draft links and joints; writes nothing.

    Args:
        options: Code page, limits and cache.
        description: URDF, SDFormat or MJCF of the same robot, whose joints and masses are taken; None for none.
        answers: Answers to questions about earlier drafts, for joints that are inferred.
        progress: Called at the start of each of the stages ``read``, ``joints`` and ``stops``.
    """
    diagnostics = Diagnostics()
    progress("read")
    try:
        described = None if description is None else read_description(description, options, diagnostics)
        diagnostics.raise_if_errors()
        what = ReadOptions(_COARSE, encoding=options.encoding, faces=True)
        with closing(Loading(step, what, options, diagnostics)) as loading:
            assembly = loading.assembly(diagnostics)
            mechanism = _mechanism(step, options)
        diagnostics.raise_if_errors()
        report_size(assembly, diagnostics, drafted=True)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return Drafting(diagnostics)
    progress("joints")
    if description is not None and described is not None:
        draft = draft_of_description(described, assembly, step_stem(step.name), description.name)
        if draft is None:
            diagnostics.add("SB824", f"the robot was not found in {step.name}", Span(description.as_posix()))
            return Drafting(diagnostics)
        draft = draft if ask is None else ask(draft, None)
        return Drafting(diagnostics, _with_densities(draft, assembly))
    stated, notes = _stated(mechanism, assembly, step)
    if stated is not None:
        draft = stated if ask is None else ask(stated, None)
    else:
        dialogue = Dialogue(Inference(assembly, step_stem(step.name)), assembly)
        dialogue.answer_all(answers or {})
        draft = dialogue.draft if ask is None else ask(dialogue.draft, dialogue)
        progress("stops")
        draft = with_stops(draft, assembly)
    draft = replace(draft, notes=(*draft.notes, *notes))
    draft = replace(draft, standing=drawn_up(draft, assembly))
    draft = replace(draft, contacts=contacts_of(draft, assembly))
    return Drafting(diagnostics, _with_densities(draft, assembly), stated is not None)


def _stated(mechanism: Mechanism | None, assembly: Assembly, step: Path) -> tuple[Draft | None, list[str]]:
    """The draft of the joints that a file states by kinematic pairs or by names, and what was ignored of them."""
    name, ignored = step_stem(step.name), []
    draft = draft_of_mechanism(mechanism, assembly, name) if mechanism is not None else None
    if draft is None:
        if mechanism is not None:
            ignored.append("the STEP file has kinematic pairs between unknown components; they were ignored")
        draft, why = draft_of_names(assembly, name)
        ignored += [why] if why else []
    ignored += [
        f"'{file}' has kinematic pairs, which were ignored: they are read from the root file only"
        for file in assembly.external_files
        if has_mechanism(step.parent / file)
    ]
    return draft, ignored


def _with_densities(draft: Draft, assembly: Assembly) -> Draft:
    return replace(draft, without_density=without_density(assembly), equal_density=equal_density(assembly))


def _mechanism(step: Path, options: Options) -> Mechanism | None:
    """The kinematic pairs in a file that was read."""
    part21 = check_step(step, str(step), Diagnostics(), options.encoding)
    return read_mechanism(step, part21.encoding) if part21 is not None else None


def kept_answers(sidecar: Path) -> dict[str, str]:
    """The answers that a sidecar keeps for the next draft; none of a file that cannot be read."""
    read = load_sidecar(sidecar, Diagnostics())
    return {} if read is None else dict(read.document.answers)


def write_draft(draft: Draft, sidecar: Path, step: Path, encoding: str, diagnostics: Diagnostics) -> str:
    """Write the sidecar, and the schema for editors if it does not exist; errors are reported in ``diagnostics``.

    Returns:
        The text of the sidecar.
    """
    text = sidecar_text(draft, relative_step(step, sidecar), encoding=encoding)
    schema = sidecar.with_name(SCHEMA_FILE)
    write_file(sidecar, text.encode("utf-8"), diagnostics)
    if not diagnostics.has_errors and not exists(schema):
        write_file(schema, schema_text().encode("utf-8"), diagnostics)
    return text
