"""Real assemblies from STEP to verified files, by the command line."""

import re
from pathlib import Path

import pytest

from tests import command_line
from tests.corpus.files import FILES, READABLE, CorpusFile

SIDECAR = """\
version: 1
robot: whole
step: {}
defaults: {{density: 1000 kg/m^3}}
links:
  all: {{rest: true}}
"""


@pytest.mark.long
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_one_link(file: CorpusFile, corpus: Path, tmp_path: Path) -> None:
    """A sidecar of one link converts every file, verified in all installed engines, or the error has the reason."""
    sidecar = tmp_path / "whole.robot.yaml"
    sidecar.write_text(SIDECAR.format((corpus / file.name).as_posix()), encoding="utf-8")
    run = command_line.stepbot("convert", sidecar, "-o", "whole", cwd=tmp_path)
    assert "Traceback" not in run.err
    if file not in READABLE:
        assert run.code == 1
        assert run.err.count("error[") == run.err.count("error[SB203]") == 4
        return
    assert run.code == 0, run.out + run.err
    assert {"whole.urdf", "whole.sdf", "whole.xml", "report.json"} <= {p.name for p in (tmp_path / "whole").iterdir()}


@pytest.mark.long
def test_the_report_of_a_large_assembly_states_what_it_reduced(corpus: Path, tmp_path: Path) -> None:
    """The page of an arm with 200,000 triangles is far below 15 MB, and states how many it shows, and how exactly."""
    text = (corpus / "joints" / "so101.robot.yaml").read_text(encoding="utf-8")
    sidecar = tmp_path / "so101.robot.yaml"
    sidecar.write_text(text.replace("../so101", (corpus / "so101").as_posix()), encoding="utf-8")
    run = command_line.stepbot("convert", sidecar, "-o", "arm", "--html", "--no-verify", "-f", "urdf", cwd=tmp_path)
    assert run.code == 0, run.out + run.err
    page = (tmp_path / "arm" / "report.html").read_text(encoding="utf-8")
    assert len(page.encode()) < 3e6
    shown = re.search(
        r"The picture has (\d+) of the (\d+) triangles in the files; no point .* farther than ([\d.]+) mm", page
    )
    assert shown is not None
    displayed, all_of_them = int(shown[1]), int(shown[2])
    assert all_of_them > 200_000 > displayed > 0.5 * all_of_them
    assert float(shown[3]) < 0.5
