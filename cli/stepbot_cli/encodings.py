"""The option for the code page of names in STEP files."""

import click


def _code_page(name: str) -> str:
    if not name:
        return ""
    from stepbot.sidecar.codepages import UnknownCodePage, code_page

    try:
        return code_page(name)
    except UnknownCodePage as failure:
        raise click.BadParameter("; ".join((str(failure), *failure.hints))) from None


encoding_option = click.option(
    "--encoding",
    type=_code_page,
    default="",
    metavar="CODEPAGE",
    help="Code page of names in the STEP file that are neither ASCII nor UTF-8, such as cp1251 or gbk.",
)
