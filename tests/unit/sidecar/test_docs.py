"""docs/sidecar.md: its examples are valid, its tables complete, and its errors those of stepbot."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import JointKind
from stepbot.robot.sensors import SensorKind
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.compose import compose
from stepbot.sidecar.contact import MATERIALS, ContactMaterial
from stepbot.sidecar.fields import key_of, section_classes
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.shapes import CollisionShape
from stepbot.sidecar.tree import plain_data
from stepbot.sidecar.units import UNITS
from stepbot.sidecar.variants import variant_names

PAGE = (Path(__file__).parents[3] / "docs" / "sidecar.md").read_text(encoding="utf-8")
COMPOSE = (Path(__file__).parents[3] / "docs" / "compose.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
WHOLE = [text for text in EXAMPLES if text.startswith("version:")]
WHOLE += [text for text in re.findall(r"^```yaml\n(.*?)^```$", COMPOSE, re.DOTALL | re.MULTILINE) if text[0] != "#"]
FRAGMENTS = [text for text in EXAMPLES if not text.startswith("version:")]

REST_OF_A_ROBOT: dict[str, Any] = {
    "version": 1,
    "robot": "arm",
    "step": "arm.step",
    "links": {"base": {"rest": True}, "forearm": {}, "hand": {}},
    "joints": {
        "elbow": {"type": "continuous", "parent": "base", "child": "forearm"},
        "wrist": {"type": "continuous", "parent": "forearm", "child": "hand"},
    },
}
GRIPPER = {"links": {"hand": {}, "left_finger": {}, "right_finger": {}}, "joints": {}}


def faults(text: str, variant: str = "") -> list[str]:
    """The diagnostics of a sidecar."""
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), diagnostics, variant)
    if sidecar is not None:
        check_sidecar(sidecar, diagnostics)
    return list(map(str, diagnostics))


@pytest.mark.parametrize("text", WHOLE, ids=lambda text: text.split("\n")[1])
def test_whole_examples_are_sound(text: str) -> None:
    """A whole sidecar has no findings, and none of its variants has."""
    assert [faults(text, variant) for variant in ("", *variant_names(text)) if faults(text, variant)] == []


@pytest.mark.parametrize("text", FRAGMENTS, ids=lambda text: text.split("\n")[1].strip())
def test_fragments_are_sound(text: str) -> None:
    """A part of a sidecar, put into a matching robot, has no findings, but for doubts about its motors."""
    tree = compose(text, "fragment", Diagnostics())
    assert tree is not None
    fragment = plain_data(tree)
    robot = dict(REST_OF_A_ROBOT)
    if "left_finger" in text:
        robot |= GRIPPER
    if "ground" in fragment.get("links", {}):
        robot |= {"links": {}, "joints": {}}
    for key, value in fragment.items():
        robot[key] = value if isinstance(value, list) else {**robot.get(key, {}), **value}
    assert [fault for fault in faults(json.dumps(robot)) if "note[SB149]" not in fault] == []


def test_errors_of_examples_are_those_on_the_page() -> None:
    """The errors of the example are the lines below it."""
    (text,) = re.findall(r"^```yaml faults\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    (lines,) = re.findall(r"^```text faults\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    assert faults(text) == lines.splitlines()


def test_every_key_and_word_is_explained() -> None:
    """Every key, type of joint, sensor and shape, and every unit is on the page."""
    code = set(re.findall(r"[\w°µ%]+", " ".join(re.findall(r"`([^`\n]+)`", PAGE + COMPOSE) + EXAMPLES)))
    keys = {key_of(name) for section in section_classes() for name in section.model_fields}
    words = {str(word) for kinds in (JointKind, SensorKind, CollisionShape) for word in kinds}
    assert keys | words | set(UNITS) <= code


def test_links_lead_somewhere() -> None:
    """Each link within the page refers to one of its headings."""
    headings = {
        re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
        for heading in re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE)
    }
    assert set(re.findall(r"\]\(#([^)]+)\)", PAGE)) <= headings


@pytest.mark.parametrize("material", MATERIALS)
def test_figures_of_materials_have_their_source(material: ContactMaterial) -> None:
    """The page states the friction of each pair, and the publication it is from."""
    friction = MATERIALS[material]
    publisher, title = friction.source.split(", ")[:2]
    assert f"`{material}` ({friction.sliding:g})" in PAGE
    assert publisher in PAGE
    assert f"*{title}*" in PAGE
