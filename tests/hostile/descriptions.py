"""Foreign robot descriptions are passed to ``verify``: bombs, entities, includes, plugins, pipes for meshes."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from msgspec import Struct

from .command import stepbot
from .experiment import Experiment, Setting, Trial

_TIMEOUT = "30"
"""Time limit [s] of an engine."""
_SECRET, _NAME, _FOLDER = "@SECRET@", "@NAME@", "@FOLDER@"
"""Placeholders for the path of a file that must not be read, its name, and its folder."""
_ENTITY = f'[<!ENTITY e SYSTEM "file://{_SECRET}">]'
_PARAMETER = f'[<!ENTITY % e SYSTEM "file://{_SECRET}">%e;]'
_MESH = f'<visual><geometry><mesh filename="{_SECRET}.obj"/></geometry></visual>'
_XINCLUDE = f'<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="file://{_SECRET}" parse="text"/>'


def _urdf(link: str = "", doctype: str = "", name: str = "r", more: str = "") -> str:
    doctype = f"<!DOCTYPE robot {doctype}>" if doctype else ""
    return f'{doctype}<robot name="{name}"><link name="a">{link}</link>{more}</robot>'


def _mjcf(head: str) -> str:
    return f'<mujoco>{head}<worldbody><body name="a"><geom size="1"/></body></worldbody></mujoco>'


def _sdf(model: str = "", world: str = "", doctype: str = "") -> str:
    doctype = f"<!DOCTYPE sdf {doctype}>" if doctype else ""
    model = f'<model name="m"><link name="a"/>{model}</model>'
    return f'{doctype}<sdf version="1.9"><world name="w">{world}{model}</world></sdf>'


def _bomb(levels: int = 9) -> str:
    entities = "".join(f'<!ENTITY e{n} "{10 * f"&e{n - 1};"}">' for n in range(1, levels))
    return f'[<!ENTITY e0 "ha">{entities}]'


def _deep(tag: str, levels: int) -> str:
    return f"<{tag}>" * levels + f"</{tag}>" * levels


class Case(Struct, frozen=True):
    """A file with placeholders for the path that it must not read."""

    name: str
    """With the suffix of its format."""
    text: str
    code: str = ""
    """The code to report; empty if the file need not be rejected."""


CASES = (
    Case("external_entity.urdf", _urdf(doctype=_ENTITY, more="&e;"), "SB820"),
    Case("include_above.xml", _mjcf(f'<include file="../{_NAME}"/>'), "SB820"),
    Case("pipe_as_mesh.urdf", _urdf(_MESH), "SB820"),
    Case("include.sdf", _sdf(world=f"<include><uri>file://{_SECRET}</uri></include>"), "SB820"),
    Case("bomb.urdf", _urdf(doctype=_bomb(), more='<link name="&e8;"/>'), "SB820"),
    Case("external_entity_in_attribute.urdf", _urdf(doctype=_ENTITY, name="&e;"), "SB814"),
    Case("parameter_entity.sdf", _sdf(doctype=_PARAMETER), "SB820"),
    Case("external_dtd.urdf", _urdf(doctype=f'SYSTEM "file://{_SECRET}"')),
    Case("network_dtd.urdf", _urdf(doctype='SYSTEM "http://127.0.0.1:9/x"')),
    Case("xinclude.urdf", _urdf(more=_XINCLUDE)),
    Case("include_absolute.xml", _mjcf(f'<include file="{_SECRET}"/>'), "SB820"),
    Case("pipe_as_mesh.xml", _mjcf(f'<asset><mesh name="m" file="{_SECRET}.obj"/></asset>'), "SB820"),
    Case(
        "pipe_in_meshdir.xml",
        _mjcf(f'<compiler meshdir="{_FOLDER}"/><asset><mesh name="m" file="{_NAME}.obj"/></asset>'),
        "SB820",
    ),
    Case("device_as_texture.xml", _mjcf('<asset><texture name="t" type="2d" file="/dev/zero"/></asset>'), "SB820"),
    Case("plugin.xml", _mjcf(f'<extension><plugin plugin="{_SECRET}"/></extension>'), "SB801"),
    Case("plugin.sdf", _sdf(f'<plugin name="p" filename="{_SECRET}.so"/>'), "SB820"),
    Case("absent_plugin.sdf", _sdf('<plugin name="p" filename="absent.so"/>')),
    Case("deep.urdf", _urdf(more=_deep("a", 100_000)), "SB814"),
    Case("deep.xml", _mjcf(_deep("worldbody", 20_000)), "SB814"),
    Case("deep.sdf", _sdf(_deep("link", 50_000)), "SB814"),
    Case("long_name.urdf", _urdf(name="x" * 11_000_000), "SB80"),
)
"""Those of the short form first: they are rejected before an engine runs."""


def run(setting: Setting) -> Iterator[Trial]:
    """Verify each file, with the pipe outside its folder."""
    for case in CASES[: setting.count]:
        place = setting.folder / case.name
        folder = place / "given"
        folder.mkdir(parents=True)
        secret = place / "secret"
        text = case.text.replace(_SECRET, str(secret)).replace(_NAME, secret.name).replace(_FOLDER, str(place))
        (folder / case.name).write_text(text, encoding="utf-8")
        with _pipes(secret, Path(f"{secret}.obj"), Path(f"{secret}.so")) as opened:
            command = ("verify", "--timeout", _TIMEOUT, case.name)
            ended = stepbot(*command, folder=folder, temporary=place / "tmp")
        faults = [*ended.faults(), *(f"opens {path.name}, which is none of its business" for path in opened)]
        if case.code not in ended.text:
            faults.append(f"{case.code} is not reported\n{ended.text[-1000:]}")
        if case.code and ended.code != 1:
            faults.append(f"exit code {ended.code}")
        yield Trial(case.name, "refused" if ended.code else "verified", tuple(faults))


@contextmanager
def _pipes(*paths: Path) -> Iterator[list[Path]]:
    """Named pipes, and a list that receives those that a process opens for reading."""
    opened: list[Path] = []

    def wait(path: Path) -> None:
        handle = os.open(path, os.O_WRONLY)  # waits for a reader
        opened.append(path)
        os.close(handle)

    for path in paths:
        os.mkfifo(path)
    threads = [threading.Thread(target=wait, args=(path,)) for path in paths]
    for thread in threads:
        thread.start()
    try:
        seen: list[Path] = []
        yield seen
        seen += opened
    finally:
        for path, thread in zip(paths, threads, strict=True):
            while thread.is_alive():  # release waiting processes
                os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
                thread.join(0.01)


EXPERIMENT = Experiment(
    "descriptions",
    "URDF, SDFormat and MJCF from elsewhere go to `verify`: entities, bombs, includes, plugins, pipes, depth, length",
    "an error that says why, in bounded time; no entity, include or plugin reads anything outside of the file's folder",
    run,
    short=4,
    long=len(CASES),
    repaired=(
        "MuJoCo and PyBullet read every `<include>` of an MJCF given to `verify`, wherever it led (SB820)",
        "a named pipe in place of a mesh held two engines until their time was up (SB820)",
        "XML entities in a URDF were a link's name to one engine and another link to the next (SB820)",
        "an `<include>` beside the model of an SDFormat world was left out in silence",
    ),
)
