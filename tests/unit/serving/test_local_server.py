"""The page's server: who gets an answer."""

import json
from collections.abc import Iterator
from http.client import HTTPConnection

import pytest

from stepbot.serving.local_server import LARGEST_QUESTION, LocalServer, Refused


def answer(question: dict[str, object]) -> dict[str, object]:
    """An echo, or a refusal."""
    if question.get("refuse"):
        raise Refused("no such face")
    return {"echo": question}


@pytest.fixture
def server() -> Iterator[LocalServer]:
    """A running server."""
    server = LocalServer(lambda: "<p>page", lambda: b'{"name":"arm"}', {"echo": answer})
    server.start()
    yield server
    server.close()


def request(
    server: LocalServer, method: str, path: str, body: bytes | None = None, **headers: str
) -> tuple[int, str, dict[str, str]]:
    """Status, body and headers of an answer; underscores in names of headers stand for dashes."""
    connection = HTTPConnection("127.0.0.1", server.port, timeout=10)
    connection.request(method, path, body, {name.replace("_", "-"): value for name, value in headers.items()})
    response = connection.getresponse()
    found = response.status, response.read().decode(), dict(response.headers)
    connection.close()
    return found


def post(server: LocalServer, question: object, **headers: str) -> tuple[int, str, dict[str, str]]:
    """Ask the page's question."""
    kind = {"Content_Type": "application/json", **headers}
    return request(server, "POST", f"/{server.token}/ask/echo", json.dumps(question).encode(), **kind)


@pytest.mark.slow
def test_page_scene_and_questions_need_the_token(server: LocalServer) -> None:
    """With the token everything is answered; without it, or with another one, nothing is."""
    assert request(server, "GET", f"/{server.token}/")[:2] == (200, "<p>page")
    assert request(server, "GET", f"/{server.token}/scene")[1] == '{"name":"arm"}'
    assert json.loads(post(server, {"a": 1})[1]) == {"echo": {"a": 1}}
    other = "x" * len(server.token)
    for path in (
        "/",
        "/scene",
        f"/{other}/",
        f"/{other}/scene",
        f"/{server.token}",
        f"/{server.token[:-1]}/",
        "/ask/echo",
    ):
        for method in ("GET", "POST"):
            status, text, _ = request(server, method, path, b"{}", Content_Type="application/json")
            assert status == 403
            assert "arm" not in text
            assert "page" not in text


def test_tokens_differ() -> None:
    """Each server has a token of its own, of at least 128 bits."""
    servers = [LocalServer(str, bytes, {}) for _ in range(2)]
    assert servers[0].token != servers[1].token
    assert len(servers[0].token) >= 22
    for one in servers:
        one.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:{port}"},
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
    ],
)
def test_requests_from_elsewhere_are_refused(server: LocalServer, headers: dict[str, str]) -> None:
    """A name that points here, another origin, a request that another site caused: refused even with the token."""
    filled = {name: value.format(port=server.port) for name, value in headers.items()}
    assert request(server, "GET", f"/{server.token}/scene", **filled)[0] == 403
    assert post(server, {}, **filled)[0] == 403


@pytest.mark.slow
def test_own_origin_is_answered(server: LocalServer) -> None:
    """What the page itself sends."""
    own = f"http://127.0.0.1:{server.port}"
    assert post(server, {}, Origin=own, Sec_Fetch_Site="same-origin")[0] == 200


@pytest.mark.slow
def test_invalid_questions(server: LocalServer) -> None:
    """No JSON, no object, too large, of another type, about nothing: an error each, and the server goes on."""
    ask = f"/{server.token}/ask/echo"
    json_type = {"Content_Type": "application/json"}
    assert request(server, "POST", ask, b"{", **json_type)[0] == 400
    assert request(server, "POST", ask, b"[" * 100_000, **json_type)[0] == 400
    assert post(server, [1])[:2] == (400, "a JSON object is expected")
    assert post(server, {"refuse": True})[:2] == (400, "no such face")
    assert request(server, "POST", ask, b"{}", Content_Type="text/plain")[0] == 415
    assert request(server, "POST", ask, None, Content_Length=str(LARGEST_QUESTION + 1), **json_type)[0] == 413
    assert request(server, "POST", ask, None, Content_Length="-1", **json_type)[0] == 413
    assert request(server, "POST", f"/{server.token}/ask/other", b"{}", **json_type)[0] == 404
    assert request(server, "GET", f"/{server.token}/../pyproject.toml")[0] == 404
    assert request(server, "DELETE", f"/{server.token}/")[0] == 501
    assert post(server, {})[0] == 200


@pytest.mark.slow
def test_answers_are_neither_kept_nor_framed(server: LocalServer) -> None:
    """Headers of every answer."""
    _, _, headers = request(server, "GET", f"/{server.token}/")
    assert headers["Cache-Control"] == "no-store"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["X-Frame-Options"] == "DENY"
    assert "Access-Control-Allow-Origin" not in headers


@pytest.mark.slow
def test_events_reach_open_and_later_pages(server: LocalServer) -> None:
    """A page that opens later gets the last event of each name; all open pages get new ones."""
    server.send("scene", {"revision": 1})
    server.send("scene", {"revision": 2})
    server.send("findings", {})
    server.forget("findings")
    pages = []
    for _ in range(2):
        connection = HTTPConnection("127.0.0.1", server.port, timeout=10)
        connection.request("GET", f"/{server.token}/events")
        pages.append(connection.getresponse())
    for page in pages:
        assert [page.readline(), page.readline(), page.readline()] == [
            b"event: scene\n",
            b'data: {"revision": 2}\n',
            b"\n",
        ]
    server.send("proof", {"name": "\u2028\n"})
    for page in pages:
        assert page.readline() == b"event: proof\n"
        assert json.loads(page.readline().removeprefix(b"data: ")) == {"name": "\u2028\n"}
    server.close()
    for page in pages:
        assert page.read() == b"\n"


@pytest.mark.slow
def test_server_listens_on_this_machine_only(server: LocalServer) -> None:
    """The address is the loopback interface."""
    assert server._http.server_address[0] == "127.0.0.1"
    assert server.url.startswith("http://127.0.0.1:")


JSON = {"Content_Type": "application/json"}
TOO_LARGE = [b"9" * 400, b"-" + b"9" * 400, b"9" * 5000, b"1e400", b"-1e999", b"Infinity", b"NaN"]


@pytest.mark.slow
@pytest.mark.parametrize("number", TOO_LARGE, ids=lambda number: number[:9].decode())
@pytest.mark.parametrize("place", [b'{"q": %s}', b'{"q": {"elbow": [%s]}}', b"%s"])
def test_numbers_that_are_none(server: LocalServer, number: bytes, place: bytes) -> None:
    """A number that no double holds is refused, wherever it is."""
    status, text, _ = request(server, "POST", f"/{server.token}/ask/echo", place % number, **JSON)
    assert status == 400
    assert text


@pytest.mark.slow
@pytest.mark.parametrize("body", [rb'{"name": "\ud800"}', rb'{"\udfff": 1}', rb'{"a": [{"b": "\ud8"}]}', b"\xff\xfe{"])
def test_text_that_is_none(server: LocalServer, body: bytes) -> None:
    """Half of a surrogate pair, and what is not UTF-8, are refused; a whole pair is text."""
    assert request(server, "POST", f"/{server.token}/ask/echo", body, **JSON)[0] == 400
    pair = rb'{"name": "\ud83e\udd16"}'
    assert request(server, "POST", f"/{server.token}/ask/echo", pair, **JSON)[0] == 200


@pytest.mark.slow
@pytest.mark.parametrize("length", ["9" * 5000, "9" * 13, "-1", "1_0", "0x10", "1e3", "\u00b2", ""])
def test_lengths_that_are_none(server: LocalServer, length: str) -> None:
    """A length with more digits than any request has, or that is no number, is refused."""
    headers = {**JSON, "Content_Length": length}
    assert request(server, "POST", f"/{server.token}/ask/echo", b"{}", **headers)[0] == 413
