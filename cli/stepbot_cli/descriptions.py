"""Options for a URDF, SDFormat or MJCF in place of a sidecar."""

from pathlib import Path

import click

base_option = click.option(
    "--base",
    type=click.Choice(["fixed", "floating"]),
    help="Whether the base of a converted URDF is fixed to the world: the format does not say.",
)
package_path_option = click.option(
    "--package-path",
    "package_path",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder of a package, or of packages, that a converted file names in package:// or model://; may be repeated.",
)
