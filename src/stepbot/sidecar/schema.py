"""The JSON Schema of the sidecar, for editors and other programs: ``python -m stepbot.sidecar.schema [FILE]``.

Generated from :mod:`stepbot.sidecar.document`; editors show the docstring below a field as its description.
https://json-schema.org/draft/2020-12
"""

import json
import re
import sys
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from .document import Document
from .fields import descriptions, section_classes
from .quantities import JointValue
from .section import NAME_PATTERN, REFERENCE_PATTERN
from .units import QUANTITY_PATTERN

ID, MOTORS_ID = "urn:stepbot:robot-1", "urn:stepbot:motors-1"
Json = dict[str, Any]

ALTERNATIVE = ("step", "links")
"""Keys that only a sidecar without modules requires."""
_SHARED: dict[str, Json] = {
    "Name": {"type": "string", "minLength": 1, "maxLength": 200, "pattern": NAME_PATTERN},
    "Reference": {"type": "string", "minLength": 1, "maxLength": 1000, "pattern": REFERENCE_PATTERN},
    "Quantity": {"type": "string", "pattern": QUANTITY_PATTERN},
}
"""Definitions that are used in so many places that they are written once."""
_SHARED_DESCRIPTIONS = {
    "Name": "A name that is valid in every output format.",
    "Reference": "The name of an element, or its path through modules: `arm/hand/tcp`.",
    "Quantity": "A number with a unit, such as `45 deg`, `12 mm`, `1.5 N*m`.",
}


class _Generator(GenerateJsonSchema):
    """Serializes the default of a joint's number as a number."""

    def encode_default(self, dft: Any) -> Any:
        return dft.value if isinstance(dft, JointValue) else super().encode_default(dft)


def json_schema() -> Json:
    """The schema as data, the same on every run."""
    generated = Document.model_json_schema(schema_generator=_Generator)
    definitions: Json = generated.pop("$defs")
    sections = {section.__name__: section for section in section_classes()}
    for name, definition in {"Document": generated, **definitions}.items():
        if name in sections:
            _describe(definition, descriptions(sections[name]))
        definition["title"] = name.removesuffix("Section")
    properties = generated["properties"]
    for name, definition in _SHARED.items():
        definitions[name] = {"title": name, "description": _SHARED_DESCRIPTIONS[name], **definition}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": ID,
        "title": "stepbot sidecar, version 1",
        "description": generated["description"],
        "type": "object",
        "required": [key for key in generated["required"] if key not in ALTERNATIVE],
        "anyOf": [{"required": list(ALTERNATIVE)}, {"required": ["modules"]}],
        "properties": _simplified(properties),
        "additionalProperties": False,
        "$defs": {
            name: definition if name in _SHARED else _simplified(definition)
            for name, definition in sorted(definitions.items())
        },
    }


def motors_schema_text() -> str:
    """The content of ``schemas/motors-1.schema.json``: a user's own file of motors, and the catalogue."""
    whole = json_schema()
    wanted, used = ["MotorSection"], {}
    while wanted:
        name = wanted.pop()
        if name not in used:
            used[name] = whole["$defs"][name]
            wanted += re.findall(r'"#/\$defs/(\w+)"', json.dumps(used[name]))
    motors = {"propertyNames": {"$ref": "#/$defs/Name"}, "additionalProperties": {"$ref": "#/$defs/MotorSection"}}
    schema = {
        "$schema": whole["$schema"],
        "$id": MOTORS_ID,
        "title": "stepbot motors, version 1",
        "description": "Motors by name, each figure with its source.",
        "type": "object",
        "required": ["motors"],
        "properties": {"motors": {"type": "object", **motors}},
        "additionalProperties": False,
        "$defs": {"Name": whole["$defs"]["Name"], **{name: used[name] for name in sorted(used) if name != "Name"}},
    }
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def schema_text() -> str:
    """The content of ``schemas/robot-1.schema.json``."""
    return json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"


def _describe(definition: Json, meanings: dict[str, str]) -> None:
    """Move the description of each key before the description of its value."""
    for key, schema in definition["properties"].items():
        how = _optional(schema).get("description", "")
        how = how[:1].upper() + how[1:]
        schema["description"] = "\n\n".join(text for text in (meanings[key], how) if text)
        schema.setdefault("title", key.replace("_", " ").title())


def _optional(schema: Json) -> Json:
    """The schema of an optional key's value, without the null that pydantic adds."""
    members = [member for member in schema.get("anyOf", []) if member != {"type": "null"}]
    return members[0] if len(members) == 1 and len(members) < len(schema["anyOf"]) else schema


def _simplified(schema: Any) -> Any:
    """The schema without nulls and empty defaults, and with shared definitions."""
    if isinstance(schema, list):
        return [_simplified(member) for member in schema]
    if not isinstance(schema, dict):
        return schema
    for name, shared in _SHARED.items():
        if shared.items() <= schema.items():
            rest = {key: value for key, value in schema.items() if key not in shared and value != ""}
            return {"$ref": f"#/$defs/{name}", **rest}
    inner = _optional(schema)
    if inner is not schema:
        schema = {**inner, **{key: value for key, value in schema.items() if key != "anyOf"}}
    result: Json = {}
    for key, value in schema.items():
        if key == "default" and (value is None or isinstance(value, dict) or value in ([], "")):
            continue
        if key == "patternProperties":
            (pattern, member) = next(iter(value.items()))
            result["propertyNames"] = {**schema["propertyNames"], "pattern": pattern}
            result["additionalProperties"] = _simplified(member)
        elif key not in result:
            result["anyOf" if key == "oneOf" else key] = _simplified(value)
    if "propertyNames" in result:
        result["propertyNames"] = _simplified({"type": "string", **result["propertyNames"]})
    return result


def main(arguments: list[str]) -> int:
    """Write the schema to a file, or to standard output."""
    if arguments:
        Path(arguments[0]).write_text(schema_text(), encoding="utf-8", newline="\n")
    else:
        sys.stdout.buffer.write(schema_text().encode("utf-8"))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
