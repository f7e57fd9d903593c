"""The option that tells in which code page a STEP file has its names."""

import click

from stepbot.sidecar.codepages import UnknownCodePage, code_page


def _code_page(name: str) -> str:
    try:
        return code_page(name) if name else ""
    except UnknownCodePage as failure:
        raise click.BadParameter("; ".join((str(failure), *failure.hints))) from None


encoding_option = click.option(
    "--encoding",
    type=_code_page,
    default="",
    metavar="CODEPAGE",
    help="Read names in the STEP that are neither ASCII nor UTF-8 in this code page, such as cp1251 or gbk.",
)
