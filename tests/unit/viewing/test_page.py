"""The page in one file."""

import json
import re
from base64 import b64encode
from hashlib import sha256
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import pytest

from stepbot.viewing import page
from stepbot.viewing.page import bundle, page_html
from stepbot.viewing.scene import scene_document
from tests.robots import ROBOTS

EVIL = "</script><script>alert(1)</script><!--\u2028 & \"'"


class Scripts(HTMLParser):
    """The script elements of a page, with their types."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[list[str]] = []
        self._inside = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Remember a script."""
        self._inside = tag == "script"
        if self._inside:
            self.found.append([dict(attrs).get("type") or "", ""])

    def handle_endtag(self, tag: str) -> None:
        """The end of a script."""
        self._inside = self._inside and tag != "script"

    def handle_data(self, data: str) -> None:
        """Its content."""
        if self._inside:
            self.found[-1][1] += data


def test_names_stay_data() -> None:
    """A name that ends a script element, starts a comment or a line changes no structure and comes back unchanged."""
    scene = {"name": EVIL}
    scripts = Scripts(page_html(EVIL, scene)).found
    assert [kind for kind, _ in scripts] == ["application/json", "module"]
    assert json.loads(scripts[0][1]) == scene
    assert "\u2028" not in scripts[0][1]


def test_policy_allows_this_style_and_script_alone() -> None:
    """The hashes in the Content-Security-Policy are those of the only style and script; nothing may be loaded."""
    text = page_html("robot", None)
    policy = unescape(re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1])  # type: ignore[index]
    script = Scripts(text).found[1][1]
    style = re.search(r"<style>(.*?)</style>", text, re.DOTALL)[1]  # type: ignore[index]
    for kind, content in (("script", script), ("style", style)):
        digest = b64encode(sha256(content.encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy
    assert "connect-src" not in policy
    assert not re.search(r"(src|href)=", text)


def test_every_module_is_in_the_bundle() -> None:
    """The page to edit with has every script of the folder, each once and after those that it imports."""
    text = bundle(("edit",))
    names = re.findall(r"^const module_(\w+) = ", text, re.MULTILINE)
    folder = Path(page.__file__).with_name("page")
    assert sorted(names) == sorted(path.stem for path in folder.glob("*.js"))
    for name in names:
        body = (folder / f"{name}.js").read_text(encoding="utf-8")
        for imported in re.findall(r'from "\./(\w+)\.js"', body):
            assert names.index(imported) < names.index(name)
    assert not re.search(r"^(import|export) ", text, re.MULTILINE)


def test_circular_imports_are_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two modules that import each other cannot be put in an order."""
    sources = {"a.js": 'import { y } from "./b.js";\n', "b.js": 'import { x } from "./a.js";\n'}
    monkeypatch.setattr(page, "_resource", sources.__getitem__)
    with pytest.raises(ValueError, match="a -> b -> a"):
        page.bundle.__wrapped__(("a",))


@pytest.mark.parametrize("name", sorted(ROBOTS))
def test_every_robot_has_a_scene(name: str) -> None:
    """Every link, joint, coordinate and closure is in the scene, and the scene is plain JSON."""
    robot = ROBOTS[name]()
    scene = json.loads(json.dumps(scene_document(robot), allow_nan=False))
    assert [link["name"] for link in scene["links"]] == [link.name for link in robot.links]
    assert [one["name"] for one in scene["connections"]] == [one.name for one in (*robot.joints, *robot.closures)]
    moving = [joint["name"] for joint in scene["motion"]["joints"] if joint["moves"]]
    listed = [name for one in scene["connections"] for name in one["coordinates"]]
    assert sorted(moving) == sorted(listed)
