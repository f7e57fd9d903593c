"""``stepbot formats`` and ``stepbot schema``."""

import json

import jsonschema

from stepbot.formats import FORMATS

from .conftest import Stepbot


def test_formats_are_those_that_are_found(stepbot: Stepbot) -> None:
    """`formats` lists every writer with its file, aliases and limitations."""
    run = stepbot("formats")
    assert run.code == 0
    assert [line.split()[0] for line in run.out.splitlines() if not line.startswith(" ")] == list(FORMATS)
    assert "alias sdformat" in run.out
    assert "not written, with a diagnostic" in run.out


def test_formats_as_json(stepbot: Stepbot) -> None:
    """`formats --json` has every feature with its level."""
    document = json.loads(stepbot("formats", "--json").out)
    (urdf,) = [one for one in document["formats"] if one["name"] == "urdf"]
    assert urdf["suffix"] == ".urdf"
    assert urdf["notions"]["mimic"]["level"] == "exact"


def test_schema_is_a_schema(stepbot: Stepbot) -> None:
    """`schema` prints a valid JSON Schema that accepts a small sidecar and rejects an unknown key."""
    schema = json.loads(stepbot("schema").out)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    sidecar = {"version": 1, "robot": "arm", "step": "arm.step", "links": {"base": {"rest": True}}}
    assert validator.is_valid(sidecar)
    assert not validator.is_valid({**sidecar, "colour": "red"})
