"""Writes edits to a sidecar: one step each, checked before it is written, undone and redone.

A change is read, built and checked as `stepbot check --step` does. Only if there is no error the file is replaced, and
every byte outside the change stays.
"""

from collections.abc import Callable
from pathlib import Path
from threading import Lock

from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.drafting import draft_step
from stepbot.pipeline.scenes import ShownScene, show_text
from stepbot.pipeline.sidecars import named_step
from stepbot.report.plain import Json
from stepbot.robot.model import Robot
from stepbot.runtime.file import read_regular, write_file
from stepbot.sidecar.draft_comments import drafted_questions
from stepbot.sidecar.editing import CannotEdit, edited
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.located import Sidecar

from .decisions import EditedSidecar, edited_view, in_file, require_editable
from .edits import changes_of
from .local_server import Refused
from .questions import text as text_of

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


Step = tuple[bytes, bytes]
"""The sidecar before and after."""


class Editor:
    """The edits of one sidecar."""

    def __init__(
        self,
        sidecar: Path,
        options: Options,
        show: Callable[[ShownScene], None],
        robot: Callable[[], Robot | None] = lambda: None,
    ) -> None:
        """Edit a sidecar; ``show`` shows what was written, ``robot`` returns the robot that is shown."""
        self._sidecar, self._options, self._show, self._robot = sidecar, options, show, robot
        self.lock = Lock()
        """Held while the file is read, changed and written."""
        self._done: list[Step] = []
        self._undone: list[Step] = []

    def edit(self, question: Json) -> Json:
        """Do what the page asks for (:mod:`.edits`).

        Raises:
            Refused: The change is not possible, or `check` would reject the result.
        """
        with self.lock:
            before = self._content()
            text, newline = _lines(before)
            try:
                actual = self._parsed(text)
                again = question.get("action") == "answer"
                changed = self._drafted_again(actual, question) if again else self._changed(actual, question)
            except CannotEdit as error:
                raise Refused(str(error)) from error
            mark = _BYTE_ORDER_MARK if before.startswith(_BYTE_ORDER_MARK) else b""
            after = mark + changed.replace("\n", newline).encode()
            if after != before:
                shown = self._written(before, after)
                self._done.append((before, after))
                self._undone.clear()
                self._show(shown)
            return self.state()

    def undo(self, question: Json) -> Json:  # noqa: ARG002 - every answer gets a question
        """Take back the last step; refused if there is none, or the file was changed elsewhere."""
        return self._move(self._done, self._undone, back=True)

    def redo(self, question: Json) -> Json:  # noqa: ARG002
        """Do the last undone step again; refused likewise."""
        return self._move(self._undone, self._done, back=False)

    def sidecar(self) -> EditedSidecar:
        """The sidecar as it is now, as the page edits it; refused if it has errors."""
        return edited_view(self._parsed(_lines(self._content())[0]), self._robot())

    def state(self) -> Json:
        """Numbers of steps that can be undone and redone."""
        return {"undo": len(self._done), "redo": len(self._undone)}

    def _move(self, taken: list[Step], given: list[Step], *, back: bool) -> Json:
        with self.lock:
            if not taken:
                raise Refused("nothing to undo" if back else "nothing to redo")
            now, then = taken[-1][::-1] if back else taken[-1]
            if self._content() != now:
                raise Refused("the sidecar was changed elsewhere; its steps cannot be undone any more")
            shown = self._written(now, then)
            given.append(taken.pop())
            self._show(shown)
            return self.state()

    def _changed(self, sidecar: Sidecar, question: Json) -> str:
        """The text with the change that a question asks for."""
        view = edited_view(sidecar, self._robot())
        require_editable(view, self._robot(), question)
        changes = in_file(sidecar, view, changes_of(view.sidecar, question), question)
        return edited(sidecar.text, changes, self._sidecar)

    def _drafted_again(self, sidecar: Sidecar, question: Json) -> str:
        """``{name, value}``: the text of the draft with another answer to a question of the draft."""
        name, value = text_of(question, "name"), text_of(question, "value")
        document = sidecar.document
        if not any(one.name == name and value in one.others for one in drafted_questions(sidecar.text)):
            raise Refused("the draft has no such question")
        try:
            step = named_step(sidecar, Diagnostics())
        except StepbotError as error:
            raise Refused(_reasons(error.diagnostics, "the STEP cannot be read")) from error
        encoding = document.step_encoding or ""
        options = self._options._replace(encoding=encoding)
        drafting = draft_step(step, options, answers={**document.answers, name: value})
        if drafting.draft is None:
            raise Refused(_reasons(drafting.diagnostics, "it cannot be drafted again"))
        return sidecar_text(replace(drafting.draft, robot=document.robot), document.step, encoding=encoding)

    def _parsed(self, text: str) -> Sidecar:
        sidecar = parse_sidecar(text, self._sidecar, diagnostics := Diagnostics())
        if sidecar is None:
            raise Refused(_reasons(diagnostics, "the sidecar has errors"))
        return sidecar

    def _content(self) -> bytes:
        try:
            return read_regular(self._sidecar)
        except OSError as error:
            raise Refused(f"the sidecar cannot be read: {error.strerror}") from error

    def _written(self, before: bytes, content: bytes) -> ShownScene:
        """Check, then write in place of ``before``; returns what to show.

        A check takes seconds: what another program saved meanwhile stays, and the edit is refused.
        """
        shown = show_text(self._sidecar, _lines(content)[0], self._options)
        if shown.diagnostics.has_errors:
            raise Refused(_reasons(shown.diagnostics, "`check` would reject this"))
        diagnostics = Diagnostics()
        write_file(self._sidecar, content, diagnostics, replaces=before)
        if diagnostics.has_errors:
            raise Refused(_reasons(diagnostics, "the sidecar cannot be written"))
        return shown


def _lines(content: bytes) -> tuple[str, str]:
    """The text with line feeds at line ends, and the line end of the file."""
    try:
        text = content.removeprefix(_BYTE_ORDER_MARK).decode()
    except UnicodeDecodeError as error:
        raise Refused("the sidecar is not UTF-8") from error
    newline = "\r\n" if "\r\n" in text else "\n"
    if newline == "\r\n" and text.count("\n") != text.count("\r\n"):
        raise Refused("the sidecar mixes line ends; save it with one kind in an editor")
    return text.replace("\r\n", "\n"), newline


def _reasons(diagnostics: Diagnostics, otherwise: str) -> str:
    """The errors, each with its first remedy."""
    errors = [diagnostic for diagnostic in diagnostics if diagnostic.severity == "error"]
    lines = [
        f"{error.message} ({error.code}){': ' + error.remedies[0] if error.remedies else ''}" for error in errors[:3]
    ]
    return "\n".join([f"{otherwise}:", *lines]) if lines else otherwise
