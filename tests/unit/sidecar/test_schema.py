"""The JSON Schema of the sidecar, by jsonschema.

It accepts what stepbot accepts, and rejects errors that a schema can express.
"""

import json
import math
import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.compose import compose
from stepbot.sidecar.fields import descriptions, section_classes
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.schema import json_schema, main, schema_text
from stepbot.sidecar.syntax_faults import compose_around_faults
from stepbot.sidecar.tree import plain_data
from tests.unit.sidecar.samples import FULL

ROOT = Path(__file__).parents[3]
SCHEMA = json_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
DIAGNOSTICS = ROOT / "tests" / "diagnostics"


def data_of(text: str) -> Any:
    """A sidecar as unvalidated data."""
    tree = compose(text, "a.robot.yaml", Diagnostics())
    assert tree is not None
    return plain_data(tree)


def faults(validator: jsonschema.Draft202012Validator, data: Any) -> list[str]:
    """Errors of data by a schema, with their places."""
    return [f"{fault.json_path}: {fault.message}" for fault in validator.iter_errors(data)]


def subschemas(schema: Any) -> list[dict[str, Any]]:
    """Every schema in a schema, including itself."""
    inner = schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else []
    return ([schema] if isinstance(schema, dict) else []) + [found for value in inner for found in subschemas(value)]


@pytest.mark.slow
def test_is_a_schema() -> None:
    """The schema is valid by the meta-schema, and has `$schema` and `$id`."""
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert SCHEMA["$id"]


@pytest.mark.slow
def test_file_is_fresh(tmp_path: Path) -> None:
    """The file in the repository is the generated one, to the byte."""
    committed = ROOT / "schemas" / "robot-1.schema.json"
    assert main([str(tmp_path / "schema.json")]) == 0
    assert (tmp_path / "schema.json").read_bytes() == committed.read_bytes() == schema_text().encode()


def test_every_key_is_described() -> None:
    """Every key of every section has a description, and every description a key."""
    assert set(descriptions(section_classes()[0])) == set(SCHEMA["properties"])
    for section in section_classes()[1:]:
        properties = SCHEMA["$defs"][section.__name__]["properties"]
        assert list(descriptions(section)) == list(properties)
        for key, schema in properties.items():
            assert schema["description"].startswith(descriptions(section)[key])
            assert schema["title"]


def test_no_value_may_be_null() -> None:
    """A key without a value is an error in the schema, too."""
    assert not any(schema.get("type") == "null" or schema.get("default", 0) is None for schema in subschemas(SCHEMA))


def test_examples_and_defaults_are_valid() -> None:
    """Examples and defaults in the schema are valid."""
    for schema in subschemas(SCHEMA):
        own = VALIDATOR.evolve(schema={**schema, "$defs": SCHEMA["$defs"]})
        for example in [*schema.get("examples", []), *([schema["default"]] if "default" in schema else [])]:
            if "title" in schema and not isinstance(schema.get("examples"), dict):
                assert faults(own, example) == []


def test_patterns_are_those_of_editors() -> None:
    """Patterns are valid ECMA 262 with the u flag: no needless escapes, no Python groups."""
    for schema in subschemas(SCHEMA):
        pattern = schema.get("pattern")
        if isinstance(pattern, str):
            assert set(re.findall(r"\\(.)", pattern)) <= set("sdx.?*+^$\\/()[]{}|"), pattern
            assert "(?" not in pattern


def test_full_sidecar_is_valid() -> None:
    """The sidecar with every key is valid."""
    assert faults(VALIDATOR, data_of(FULL)) == []


TOLD_BY_SCHEMA = ("SB120", "SB121_missing", "SB121_no", "SB122", "SB123", "SB126_names", "SB127", "SB128_two")


@pytest.mark.parametrize(
    "folder", sorted(f for f in DIAGNOSTICS.iterdir() if f.name.startswith(TOLD_BY_SCHEMA)), ids=lambda f: f.name
)
def test_editors_mark_what_is_wrong(folder: Path) -> None:
    """Unknown keys, missing keys, wrong types, words and names are errors in the schema."""
    assert not VALIDATOR.is_valid(data_of((folder / "robot.robot.yaml").read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "folder",
    sorted(
        f.parent for f in DIAGNOSTICS.glob("*/robot.robot.yaml") if re.match("SB1(28_auto|3)|SB4[56]", f.parent.name)
    ),
    ids=lambda f: f.name,
)
def test_schema_is_not_stricter(folder: Path) -> None:
    """Contradictions between values are not errors in the schema."""
    assert faults(VALIDATOR, data_of((folder / "robot.robot.yaml").read_text(encoding="utf-8"))) == []


WORDS = [
    "7",
    "-1",
    "0",
    "[]",
    "{}",
    "'x y'",
    "true",
    "1 kg",
    "12 mm",
    "45 deg",
    "1e3",
    "auto",
    "[0, 0, 1]",
    "hull",
    "-inf",
    "x",
]


@pytest.mark.slow
@given(data=st.data())
def test_what_is_loaded_is_valid(data: st.DataObject) -> None:
    """A sidecar with values exchanged at random is valid by the schema if stepbot loads it."""
    text = FULL
    for _ in range(data.draw(st.integers(1, 3))):
        places = [match.span(1) for match in re.finditer(r": ([^\s{}\[\],][^{}\[\],\n]*)", text)]
        start, end = data.draw(st.sampled_from(places))
        text = text[:start] + data.draw(st.sampled_from(WORDS)) + text[end:]
    if parse_sidecar(text, Path("a.robot.yaml"), Diagnostics()) is not None:
        assert faults(VALIDATOR, data_of(text)) == []


def test_infinity_is_a_number() -> None:
    """YAML's infinity is valid, although JSON has none."""
    text = FULL.replace("upper: 1}", "upper: .inf}")
    assert data_of(text)["joints"]["lift"]["limits"]["upper"] == math.inf
    VALIDATOR.validate(data_of(text))


@pytest.mark.slow
def test_schema_is_plain_json() -> None:
    """The text is valid JSON, and read equally as YAML."""
    assert json.loads(schema_text()) == SCHEMA
    assert compose_around_faults(schema_text(), "schema.json", Diagnostics()).whole
