"""``stepbot schema``: print the JSON Schema of the sidecar."""

import json

import click

from .command import Command
from .terminal import write_result

FILES = ("*.robot.yaml", "*.robot.yml", "robot.yaml", "robot.yml")
"""File names of sidecars."""


@click.command(cls=Command, epilog="Example: stepbot schema > robot-1.schema.json")
@click.option("--vscode", is_flag=True, help="Print VS Code settings that apply the schema to all sidecars.")
@click.option("--motors", is_flag=True, help="Print the schema of a file of motors of your own.")
def command(vscode: bool, motors: bool) -> int:
    """Print the JSON Schema of the sidecar, for editors and scripts."""
    if vscode:
        from stepbot.runtime.robot_library import schema_file

        settings = {"yaml.schemas": {schema_file().as_uri(): list(FILES)}}
        write_result(json.dumps(settings, indent=2, ensure_ascii=False))
        return 0
    from stepbot.sidecar.schema import motors_schema_text, schema_text

    write_result(motors_schema_text() if motors else schema_text())
    return 0
