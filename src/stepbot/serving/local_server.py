"""HTTP on 127.0.0.1 for one page: a random token in every path, requests from other sites refused, no files served.

What a conversion made is served from memory.

Another program or site on this machine can reach the port, but not what is behind the token. The Host header must name
this machine, which keeps out sites whose name is made to point here (DNS rebinding).
"""

import json
import secrets
from collections.abc import Callable, Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from math import isfinite
from queue import Empty, SimpleQueue
from threading import Lock, Thread
from urllib.parse import unquote

from stepbot.report.plain import Json

Answer = Callable[[Json], Json]

ADDRESS = "127.0.0.1"
LARGEST_QUESTION = 1 << 20
"""Maximum size [bytes] of a request."""
HEARTBEAT = 10.0
"""Seconds between two signs of life to a page: a closed one is noticed."""
_TOKEN_BYTES = 24
_LONGEST_LENGTH = 12
"""Digits of a length; more are too large, and Python converts no more than 4,300."""


class Refused(Exception):
    """A question cannot be answered; the message is shown in the page."""


class LocalServer:
    """Serves one page, its scene, its events, and answers to its questions."""

    def __init__(
        self,
        page: Callable[[], str],
        scene: Callable[[], bytes],
        answers: Mapping[str, Answer],
        port: int = 0,
        made: Callable[[], Mapping[str, bytes]] = dict,
    ):
        """Bind the port; :meth:`start` serves.

        Args:
            scene: Makes the scene as JSON, UTF-8.
            answers: By name, functions that answer questions of the page.
            port: The port; 0 for any free one.
            made: Files that the page may load, by name: held in memory, not read from a disk.

        Raises:
            OSError: The port is in use, or not allowed.
        """
        self.token = secrets.token_urlsafe(_TOKEN_BYTES)
        self._page, self._scene, self._answers, self._made = page, scene, answers, made
        self._listeners: list[SimpleQueue[bytes | None]] = []
        self._last: dict[str, bytes] = {}
        self._lock = Lock()
        self._http = _Server(self, port)
        self._thread = Thread(target=self._http.serve_forever, name="page server", daemon=True)

    @property
    def port(self) -> int:
        """The port in use."""
        return int(self._http.server_address[1])

    @property
    def url(self) -> str:
        """Address of the page, with its token."""
        return f"http://{ADDRESS}:{self.port}/{self.token}/"

    def start(self) -> None:
        """Serve in a thread of its own."""
        self._thread.start()

    def close(self) -> None:
        """End all connections and free the port."""
        with self._lock:
            for listener in self._listeners:
                listener.put(None)
        if self._thread.is_alive():
            self._http.shutdown()
        self._http.server_close()

    def send(self, event: str, content: Json) -> None:
        """Send an event to all open pages; a page that opens later gets the last one of each name."""
        message = f"event: {event}\ndata: {json.dumps(content, ensure_ascii=True)}\n\n".encode()
        with self._lock:
            self._last.pop(event, None)
            self._last[event] = message
            for listener in self._listeners:
                listener.put(message)

    def forget(self, event: str) -> None:
        """Do not send the last event of a name to pages that open later."""
        with self._lock:
            self._last.pop(event, None)

    def _listen(self) -> "SimpleQueue[bytes | None]":
        queue: SimpleQueue[bytes | None] = SimpleQueue()
        with self._lock:
            for message in self._last.values():
                queue.put(message)
            self._listeners.append(queue)
        return queue


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    allow_reuse_address = True

    def __init__(self, local: LocalServer, port: int) -> None:
        self.local = local
        super().__init__((ADDRESS, port), _Handler)


_HTML = "text/html; charset=utf-8"


class _Handler(BaseHTTPRequestHandler):
    """Answers requests below the token of the server's page."""

    server: _Server
    protocol_version = "HTTP/1.1"
    server_version = "stepbot"
    sys_version = ""
    timeout = 60.0

    def handle(self) -> None:
        """Answer requests until the page is closed, which may be in the middle of an answer."""
        with suppress(ConnectionError):
            super().handle()

    def do_GET(self) -> None:
        match self._place():
            case "":
                self._send(self.server.local._page().encode(), _HTML)
            case "scene":
                self._send(self.server.local._scene(), "application/json")
            case "events":
                self._stream()
            case None:
                self._refuse(HTTPStatus.FORBIDDEN)
            case place if (made := self.server.local._made().get(unquote(place.removeprefix("files/")))) is not None:
                self._send(made, _HTML if place.endswith(".html") else "application/octet-stream")
            case _:
                self._refuse(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        place = self._place()
        name = (place or "").removeprefix("ask/")
        if place is None:
            self._refuse(HTTPStatus.FORBIDDEN)
        elif not place.startswith("ask/") or name not in self.server.local._answers:
            self._refuse(HTTPStatus.NOT_FOUND)
        elif self.headers.get_content_type() != "application/json":
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE)
        else:
            self._answer(self.server.local._answers[name])

    def _answer(self, answer: Answer) -> None:
        length = self.headers.get("Content-Length", "")
        is_length = length.isascii() and length.isdigit() and len(length) <= _LONGEST_LENGTH
        if not is_length or int(length) > LARGEST_QUESTION:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        try:
            question = _parsed(self.rfile.read(int(length)))
            content = json.dumps(answer(question)).encode()
        except (Refused, ValueError, OverflowError, RecursionError) as error:
            reason = str(error).encode("utf-8", "backslashreplace")
            self._send(reason, "text/plain; charset=utf-8", HTTPStatus.BAD_REQUEST)
        else:
            self._send(content, "application/json")

    def _place(self) -> str | None:
        """The path below the token; None for a request that must not be answered."""
        here = {f"{name}:{self.server.local.port}" for name in (ADDRESS, "localhost")}
        origin = self.headers.get("Origin")
        if self.headers.get("Host") not in here:
            return None
        if origin is not None and origin not in {f"http://{host}" for host in here}:
            return None
        if self.headers.get("Sec-Fetch-Site", "none") not in ("same-origin", "none"):
            return None
        token, slash, place = self.path.removeprefix("/").partition("/")
        is_ours = secrets.compare_digest(token.encode(), self.server.local.token.encode())
        return place if is_ours and slash else None

    def _stream(self) -> None:
        self.close_connection = True
        self.send_response(HTTPStatus.OK)
        self._headers("text/event-stream")
        queue = self.server.local._listen()
        try:
            while True:
                try:
                    message = queue.get(timeout=HEARTBEAT)
                except Empty:
                    message = b": still here\n\n"
                if message is None:
                    return
                self.wfile.write(message)
                self.wfile.flush()
        except OSError:  # the page was closed
            return
        finally:
            with self.server.local._lock:
                self.server.local._listeners.remove(queue)

    def _send(self, content: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK) -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        self._headers(kind)
        self.wfile.write(content)

    def _headers(self, kind: str) -> None:
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("X-Frame-Options", "DENY")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.end_headers()

    def _refuse(self, status: HTTPStatus) -> None:
        self.close_connection = True
        self._send(f"{status.phrase}\n".encode(), "text/plain; charset=utf-8", status)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the base class's name
        """Requests are not logged: their paths hold the token."""


def _parsed(content: bytes) -> Json:
    """A question whose texts are Unicode and whose numbers are finite doubles, so that every answer can use them.

    Raises:
        Refused: It is not a JSON object of these.
        ValueError: It is not JSON.
    """
    question = json.loads(content, parse_int=_number, parse_float=_number, parse_constant=_number)
    if not isinstance(question, dict):
        raise Refused("a JSON object is expected")
    try:
        json.dumps(question, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        raise Refused("a text has half of a surrogate pair") from None
    return question


def _number(text: str) -> float:
    value = float(text)
    if not isfinite(value):
        raise Refused("a number is too large")
    return int(text) if text.lstrip("-").isdigit() else value
