"""What one page shows and asks: a scene, its verification, faces that were clicked."""

import threading
from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext
from pathlib import Path

from stepbot.diagnostics import Diagnostics, source_lines
from stepbot.jobs.incremental import convert, produce
from stepbot.pipeline.conversion import Conversion, Options, write
from stepbot.pipeline.loading import hold_geometry, release_geometry
from stepbot.pipeline.scenes import ShownScene, guessed, show
from stepbot.report.plain import Json
from stepbot.runtime.file import resolved
from stepbot.runtime.output import failed_output
from stepbot.viewing.joining import clicked_face
from stepbot.viewing.page import page_html
from stepbot.viewing.scene import diagnostic_documents, proof_document, scene_text

from .axis_questions import Contacts, axes_between, axes_of_joint
from .decisions import module_command, vocabulary, written
from .editor import Editor
from .local_server import LocalServer, Refused

Produce = Callable[[Path, Options], Conversion]
"""Converts a sidecar, and writes nothing."""
Signature = tuple[tuple[Path, tuple[int, int, int]], ...]
"""For each file its time [ns], size and number in the file system; zeros for a missing one."""


class Session:
    """A target and its page."""

    def __init__(
        self, target: Path, options: Options, *, port: int = 0, writes: bool = False, edits: bool = False
    ) -> None:
        """Bind the port; :meth:`load` shows the target.

        Args:
            options: Limits and cache; formats and engines for verification.
            port: The port; 0 for any free one.
            edits: Whether the page may change the target, a sidecar.
            writes: Whether :meth:`prove` writes the files to ``options.output``.

        Raises:
            OSError: The port cannot be used.
        """
        self.target, self._options, self._writes = target, options, writes
        self.files: tuple[Path, ...] = (target,)
        """The files of the last reading, whether it succeeded or not."""
        self._seen: Signature = ()
        """The files as they were read or written last."""
        self._last: Signature = ()
        """The files at the last call of :meth:`refresh`."""
        self._lock = threading.Lock()
        self._scene = b"null"
        self._shown: ShownScene | None = None
        self._is_current = False
        """Whether what is shown is what the files have: not after a save with errors."""
        self._revision = 0
        self._made: Mapping[str, bytes] = {}
        """Files of the last conversion that the page asked for."""
        self._converting = threading.Lock()
        self.on_reading: Callable[[], None] = lambda: None
        """Called before the target is read again or edited."""
        self.on_edit: Callable[[], None] = lambda: None
        """Called after an edit was shown."""
        self._editor: Editor | None = None
        self._contacts = Contacts(options.memory_limit)
        answers = {"face": self._face, "contacts": lambda question: self._contacts.answer(self._shown, question)}
        if edits:
            self._editor = Editor(
                target, options, self._edited, lambda: None if self._shown is None else self._shown.robot
            )
            editor = self._editor
            answers |= {
                "edit": lambda question: self._revised(editor.edit, question),
                "undo": lambda question: self._revised(editor.undo, question),
                "redo": lambda question: self._revised(editor.redo, question),
                "between": lambda question: axes_between(self._shown, question),
                "convert": lambda question: self._convert(),
                "written": lambda question: self._written(editor),
                "vocabulary": lambda question: vocabulary(),
                "lines": lambda question: axes_of_joint(self._shown, editor.sidecar().sidecar, question),
            }
        self.server = LocalServer(self._page, lambda: self._scene, answers, port, lambda: self._made)
        hold_geometry(self)

    def load(self) -> ShownScene:
        """Read the target and show it; after errors the page keeps the last robot, if there was one."""
        self.on_reading()
        before = _signature(self.files)
        shown = show(self.target, self._options)
        self.files = shown.files or (self.target,)
        # A save while it was read is one to show: what was known before counts.
        self._seen = tuple(sorted({**dict(_signature(self.files)), **dict(before)}.items()))
        if shown.scene is None or (shown.diagnostics.has_errors and self._shown is not None):
            self._is_current = False
            self.server.send("findings", {"diagnostics": _documents(shown.diagnostics)})
            return shown
        self._set(shown)
        return shown

    def refresh(self) -> ShownScene | None:
        """Read the target again if another program has saved one of its files, and has finished; None otherwise."""
        now = _signature(self.files)
        settled, self._last = now == self._last, now
        if not settled or self._is_shown(now):
            return None
        with self._editor.lock if self._editor is not None else nullcontext():
            return None if self._is_shown(_signature(self.files)) else self.load()

    def _is_shown(self, now: Signature) -> bool:
        return set(now) <= set(self._seen)

    def guess(self) -> None:
        """Show the joints that inference finds in a plain STEP file; nothing for other targets."""
        shown = self._shown
        if shown is not None and shown.sidecar is None and shown.assembly is not None:
            self.server.send("busy", {"text": "looking for joints"})
            self._set(guessed(shown, self.target, self._options))

    def _set(self, shown: ShownScene) -> None:
        with self._lock:
            self._shown, self._is_current = shown, True
            self._scene = scene_text(shown.scene or {}).encode("utf-8", "backslashreplace")
            self._revision += 1
        for event in ("findings", "proof", "busy"):
            self.server.forget(event)
        edit = None if self._editor is None else self._editor.state()
        self.server.send("scene", {"revision": self._revision, "edit": edit})

    def _edited(self, shown: ShownScene) -> None:
        self.files = shown.files or self.files
        self._seen = _signature(self.files)
        self._set(shown)
        self.on_edit()

    def _revised(self, change: Callable[[Json], Json], question: Json) -> Json:
        """The answer to a change, with the revision of the scene that has it."""
        self.on_reading()
        answer = change(question)
        with self._lock:
            return {**answer, "revision": self._revision}

    def _written(self, editor: Editor) -> Json:
        shown = self._shown
        view = editor.sidecar()
        document = written(view, {} if shown is None or shown.scene is None else shown.scene)
        modules = () if shown is None or shown.robot is None else shown.robot.modules
        places = [
            {"name": module.name, "links": module.links, "edit": module_command(view.sidecar, module)}
            for module in modules
        ]
        return {**document, "modules": places}

    def prove(self, run: Produce = produce) -> Conversion | None:
        """Convert the sidecar that is shown, verify the files, and show the result.

        None for other targets, and after a save with errors.

        Args:
            run: Converts it, here or in another process.
        """
        shown = self._shown
        if shown is None or not self._is_current or shown.sidecar is None or shown.diagnostics.has_errors:
            return None
        documents = _documents(shown.diagnostics)
        self.server.send("proof", {"proof": None, "diagnostics": documents, "proving": True})
        conversion = run(shown.sidecar, self._options)
        if self._writes:
            conversion = write(conversion, self._options.output, shown.sidecar)
        if shown is self._shown:
            self._send_proof(conversion)
        return conversion

    def _convert(self) -> Json:
        """Do what `stepbot convert --html` does: ``{folder, files, written}``; the page hears of each stage."""
        if not self._converting.acquire(blocking=False):
            raise Refused("a conversion is running")
        try:
            options = self._options._replace(verify=True, html=True)
            conversion = convert(self.target, options, lambda stage: self.server.send("converting", {"stage": stage}))
        finally:
            self._converting.release()
            self.server.forget("converting")
        is_written = not conversion.diagnostics.has_errors
        folder = options.output if is_written else failed_output(options.output)
        self._made = conversion.files
        self._send_proof(conversion)
        files = sorted(conversion.files, key=lambda name: ("/" in name, name))
        return {"folder": resolved(folder).as_posix(), "files": files, "written": is_written}

    def _send_proof(self, conversion: Conversion) -> None:
        diagnostics: Diagnostics = conversion.diagnostics
        proof = None if conversion.report is None else proof_document(conversion.report)
        self.server.send("proof", {"proof": proof, "diagnostics": _documents(diagnostics), "proving": False})

    def close(self) -> None:
        """End the server."""
        self.server.close()
        self._contacts.close()
        release_geometry(self)

    def _page(self) -> str:
        modules = ("live",) if self._editor is None else ("edit",)
        return page_html(self.target.name, None, modules=modules, connect="'self'")

    def _face(self, question: Json) -> Json:
        """The axis of a clicked face: ``{component, triangle}``."""
        shown = self._shown
        if shown is None or shown.assembly is None:
            return {}
        assembly = shown.assembly
        index = assembly.index_of.get(str(question.get("component")))
        triangle = _triangle(question.get("triangle"))
        if index is None or assembly.components[index].body < 0 or triangle is None:
            raise Refused("no such face")
        clicked = clicked_face(assembly, index, triangle)
        if clicked is None:
            return {"why": "This face has no axis."}
        face, origin = clicked
        line = {"component": question["component"], "point": face.point, "direction": face.direction}
        kind = "cone" if face.cone else "bore" if face.bore else "shaft"
        return {"kind": kind, "radius": face.radius, "origin": origin, "line": line}


def _documents(diagnostics: Diagnostics) -> list[Json]:
    return diagnostic_documents(diagnostics, source_lines(diagnostics))


def _signature(files: Iterable[Path]) -> Signature:
    signature = []
    for path in files:
        try:
            status = path.stat()
        except OSError:
            signature.append((path, (0, 0, 0)))
        else:
            signature.append((path, (status.st_mtime_ns, status.st_size, status.st_ino)))
    return tuple(sorted(signature))


def _triangle(value: object) -> list[list[float]] | None:
    """Three corners of three numbers; None for anything else."""
    if not isinstance(value, list) or len(value) != 3:
        return None
    for corner in value:
        if not isinstance(corner, list) or len(corner) != 3:
            return None
        if not all(isinstance(x, int | float) and not isinstance(x, bool) for x in corner):
            return None
    return value
