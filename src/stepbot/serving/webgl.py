"""Whether the browser of this machine draws the pages: one that it opens reports what its WebGL is."""

import webbrowser
from collections.abc import Callable
from queue import Empty, SimpleQueue

from msgspec.structs import replace

from stepbot.jobs.health import OK, PROBLEM, Item
from stepbot.report.plain import Json

from .local_server import LocalServer
from .questions import text

_SECONDS = 30.0
_SOFTWARE = ("swiftshader", "llvmpipe", "softpipe", "basic render", "software")
"""Words in the names of renderers that use no graphics card."""
_FIX = "turn on hardware acceleration in the browser's settings, update the graphics driver, or use another browser"
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>stepbot doctor</title><link rel="icon" href="data:,"></head>
<body><p role="status">Asking for WebGL 2 ...</p><script>
const gl = document.createElement("canvas").getContext("webgl2");
const names = gl?.getExtension("WEBGL_debug_renderer_info");
const renderer = gl ? String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : "";
const content = { renderer, browser: navigator.userAgent.match(/(?:Firefox|Edg|Chrome|Version)\\/[\\d.]+/)?.[0] ?? "" };
fetch("ask/webgl", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(content) })
  .then(() => { document.querySelector("p").textContent = `${renderer || "no WebGL 2"}. This page can be closed.`; });
</script></body></html>
"""


def examine_webgl(open_page: Callable[[str], object] = webbrowser.open, seconds: float = _SECONDS) -> Item:
    """What a page reports that a browser opens.

    Args:
        open_page: Opens an address in a browser; returns False if there is none.
        seconds: How long to wait for the report [s].
    """
    item = Item("browser", "WebGL 2", OK, "", "draws the pages of `view`, `watch` and `convert --html`")
    answers: SimpleQueue[tuple[str, str]] = SimpleQueue()

    def heard(question: Json) -> Json:
        answers.put((text(question, "renderer")[:200], text(question, "browser")[:200]))
        return {}

    server = LocalServer(lambda: _PAGE, lambda: b"null", {"webgl": heard})
    try:
        server.start()
        if open_page(server.url) is False:
            return replace(item, state=PROBLEM, detail="no browser was found", fix="export BROWSER=PROGRAM")
        renderer, browser = answers.get(timeout=seconds)
    except Empty:
        return replace(item, state=PROBLEM, detail=f"no answer from a browser within {seconds:g} s", fix=_FIX)
    finally:
        server.close()
    if not renderer:
        return replace(item, state=PROBLEM, detail=f"{browser}: no WebGL 2", fix=_FIX)
    is_slow = any(word in renderer.lower() for word in _SOFTWARE)
    return replace(item, detail=f"{browser}: {renderer}{', without a graphics card: slow' if is_slow else ''}")
