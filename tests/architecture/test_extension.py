"""A new format and a new engine are one folder each, without any other edit of stepbot."""

import json
import os
import shutil
import sys
from importlib.metadata import version
from pathlib import Path
from subprocess import run as run_process

import pytest
from msgspec import Struct

from tests.command_line import Run, environment

ROOT = Path(__file__).resolve().parents[2]

FORMAT = '''\
"""Links and masses as XML."""

from ..format import Format

FORMAT = Format(__name__, "dummy", "DummyML", suffix=".dummy.txt", root="dummy", order=90, aliases=("dml",))
'''
OPTIONAL_FORMAT = FORMAT.replace('"dummy", "DummyML"', '"rare", "RareML"').replace(
    'suffix=".dummy.txt", root="dummy", order=90, aliases=("dml",)',
    'suffix=".rare", root="rare", order=95, default=False',
)
WRITER = '''\
"""The writer."""

from ..features import Feature, exact

EXPRESSES = {feature: exact("`<dummy>`") for feature in Feature}


def reserves(name):
    return False


def companions(robot):
    return ()


def scenes(robot):
    return {}


def render(robot):
    links = "".join(f'<link name="{link.name}" mass="{link.mass_properties.mass!r}"/>' for link in robot.links)
    return f'<dummy name="{robot.name}">{links}</dummy>'.encode()
'''
ENGINE = '''\
"""Reads links and masses, the latter to a part in a thousand."""

from ..engine import Engine, Tolerance, always

ENGINE = Engine(
    __name__,
    "dummy_engine",
    formats=("dummy",),
    available=always,
    order=90,
    tolerances={"mass": Tolerance(relative=2e-3)},
    distribution="click",
)
'''
OBSERVER = '''\
"""The observer."""

from pathlib import Path
from xml.etree.ElementTree import fromstring

from ..observation import Observation, ObservedLink, Quantity
from . import ENGINE


def prepare():
    pass


def observe(request):
    robot = fromstring(Path(request.file).read_text())
    links = tuple(ObservedLink(link.get("name"), 1.001 * float(link.get("mass"))) for link in robot)
    told = (Quantity.LOAD, Quantity.LINKS, Quantity.MASS, Quantity.WARNINGS)
    not_run = {quantity: "not read" for quantity in Quantity if quantity not in told}
    return Observation(ENGINE.name, "1.0", request.format, robot.get("name"), links=links, not_run=not_run)
'''


class Extended(Struct, frozen=True):
    """A copy of stepbot with three more folders, and a folder to work in."""

    root: Path
    desk: Path

    def python(self, *arguments: str) -> Run:
        """Run the interpreter with the copy on its path, in the folder to work in."""
        paths = os.pathsep.join(str(self.root / name) for name in ("src", "cli", "docs"))
        done = run_process(
            [sys.executable, *arguments],
            cwd=self.desk,
            env=environment({"PYTHONPATH": paths, "STEPBOT_CACHE": str(self.desk / "cache")}),
            capture_output=True,
            timeout=300,
            check=False,
        )
        return Run(done.returncode, done.stdout.decode("utf-8"), done.stderr.decode("utf-8"))

    def stepbot(self, *arguments: str) -> Run:
        """Run a command of the copy."""
        return self.python("-m", "stepbot_cli", *arguments)


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Extended:
    """The copy: two formats, one of which is not written by default, and one engine."""
    root, desk = tmp_path_factory.mktemp("copy"), tmp_path_factory.mktemp("desk")
    for folder in ("src", "cli", "schemas", "docs"):
        shutil.copytree(ROOT / folder, root / folder, ignore=shutil.ignore_patterns("__pycache__"))
    for place, declaration, module, code in (
        ("formats/dummy", FORMAT, "writer.py", WRITER),
        ("formats/rare", OPTIONAL_FORMAT, "writer.py", WRITER),
        ("engines/dummy", ENGINE, "observer.py", OBSERVER),
    ):
        added = root / "src" / "stepbot" / place
        added.mkdir()
        (added / "__init__.py").write_text(declaration, encoding="utf-8")
        (added / module).write_text(code, encoding="utf-8")
    for file in ("arm2.robot.yaml", "arm2.step"):
        shutil.copy(robot_library / "stepbot_arm2" / file, desk)
    return Extended(root, desk)


@pytest.mark.slow
def test_commands_list_an_added_format(extended: Extended) -> None:
    """`formats`, the help of `-f`, the message for an unknown format, and the mapping page list the new format."""
    listed = json.loads(extended.stepbot("formats", "--json").out)["formats"]
    assert [one["name"] for one in listed] == ["urdf", "sdf", "mjcf", "usd", "webots", "dummy", "rare"]
    assert (listed[-2]["suffix"], listed[-2]["aliases"]) == (".dummy.txt", ["dml"])
    help_text = " ".join(extended.stepbot("convert", "--help").out.split())
    assert "urdf, sdf, mjcf, usd, webots, dummy, rare; may be repeated. [default: urdf,sdf,mjcf,dummy]" in help_text
    assert "URDF, SDFormat, MJCF and DummyML" in extended.stepbot("--help").out
    assert "did you mean 'dummy'?" in extended.stepbot("convert", "arm2.robot.yaml", "-f", "dumy").err
    page = extended.python("-c", "from mapping_page import mapping_page; print(mapping_page())").out
    assert "| | URDF | SDFormat | MJCF | OpenUSD | Webots | DummyML | RareML |" in page.splitlines()


@pytest.mark.slow
def test_an_added_format_is_written_and_read_by_an_added_engine(extended: Extended) -> None:
    """`convert -f` with its alias writes the format and runs the engine; `verify` detects it by its root element."""
    converted = extended.stepbot("convert", "arm2.robot.yaml", "-f", "dml", "-o", "out", "--require", "dummy_engine")
    assert converted.code == 0, converted.err
    assert (
        (extended.desk / "out" / "arm2.dummy.txt").read_text(encoding="utf-8").startswith('<dummy name="arm2"><link ')
    )
    report = json.loads((extended.desk / "out" / "report.json").read_text(encoding="utf-8"))
    loaded = [check for check in report["checks"] if check["engine"] == "dummy_engine" and check["quantity"] == "load"]
    assert [check["status"] for check in loaded] == ["passed"]
    (mass,) = (check for check in report["checks"] if (check["engine"], check["quantity"]) == ("dummy_engine", "mass"))
    assert mass["status"] == "passed"
    assert mass["deviation"] == pytest.approx(mass["tolerance"] / 2.0, rel=1e-6)

    shutil.copy(extended.desk / "out" / "arm2.dummy.txt", extended.desk / "other.file")
    verified = extended.stepbot("verify", "other.file", "--json")
    assert verified.code == 0, verified.err
    checks = json.loads(verified.out)["report"]["checks"]
    assert {check["engine"] for check in checks} == {"dummy_engine"}
    assert {check["format"] for check in checks} == {"dummy"}


def test_the_version_of_an_added_engine_is_that_of_its_distribution(extended: Extended) -> None:
    """`doctor` lists an engine with the version of the distribution that it declares."""
    items = json.loads(extended.stepbot("doctor", "--json").out)["items"]
    (added,) = (item for item in items if item["name"] == "dummy_engine")
    assert (added["state"], added["detail"]) == ("ok", version("click"))


@pytest.mark.slow
def test_what_is_written_by_default_is_computed(extended: Extended) -> None:
    """Library and command line write all formats declared as `default`."""
    program = "from stepbot.pipeline.conversion import Options; print(Options('.').formats)"
    assert extended.python("-c", program).out.strip() == "('urdf', 'sdf', 'mjcf', 'dummy')"
