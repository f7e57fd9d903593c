"""Real assemblies from STEP to verified files, by the command line."""

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
