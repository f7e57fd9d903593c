"""The batch whose memory is measured has as many distinct robots as requested, and the table shows when it grows."""

from pathlib import Path

import pytest

from benchmarks.many_robots import batch_memory, distinct_copies, memory_table
from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import ReadOptions
from stepbot.step.reader import read_assembly

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "robot_library"


@pytest.mark.slow
def test_copies_are_distinct_and_in_turn(tmp_path: Path) -> None:
    """Two robots, five copies: other names, other bytes, and the kernel reads the same assembly from each."""
    listed = tmp_path / "two.txt"
    robots = [LIBRARY / "stepbot_arm2" / "arm2.robot.yaml", LIBRARY / "stepbot_four_bar" / "four_bar.robot.yaml"]
    listed.write_text("\n".join(map(str, robots)), encoding="utf-8")
    copies = distinct_copies(listed, 5, tmp_path / "copies")
    sidecars = sorted(copies.rglob("*.robot.yaml"))
    assert [path.name.partition(".")[0] for path in sidecars] == ["arm2", "four_bar", "arm2", "four_bar", "arm2"]
    steps = sorted(copies.rglob("*.step"))
    assert len({path.read_bytes() for path in steps}) == len({path.read_bytes() for path in sidecars}) == 5
    read = read_assembly(steps[0], ReadOptions(), Diagnostics())
    original = read_assembly(robots[0].with_suffix("").with_suffix(".step"), ReadOptions(), Diagnostics())
    assert read is not None
    assert original is not None
    assert [one.path for one in read.components] == [one.path for one in original.components]


@pytest.mark.parametrize("text", ["version: 1\nrobot: a\n", None], ids=["no step", "no sidecars"])
def test_nothing_to_copy(text: str | None, tmp_path: Path) -> None:
    """A folder without sidecars, and a sidecar that names no STEP, end the benchmark."""
    if text is not None:
        (tmp_path / "a.robot.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit, match="names no STEP" if text else "no sidecars found"):
        distinct_copies(tmp_path, 1, tmp_path / "copies")


def test_table_of_growing_memory() -> None:
    """Each tenth has the mean and the peak of the samples in it."""
    samples = [(0.0, 0.0), *((second + 0.5, 100.0 + second) for second in range(10)), (10.0, 100.0)]
    rows = memory_table(samples).splitlines()
    assert rows[2] == "| 1 | 1 | 50 | 100 |"
    assert rows[6] == "| 5 | 5 | 104 | 104 |"
    assert rows[11].endswith("| 109 |")


@pytest.mark.long
@pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="memory is measured on Linux")
def test_memory_of_a_real_batch(tmp_path: Path) -> None:
    """Three robots are converted, and every sample after the start has memory of at least an interpreter."""
    copies = distinct_copies(LIBRARY / "stepbot_arm2", 3, tmp_path / "copies")
    samples = batch_memory(copies, tmp_path / "made", 2)
    assert len(list((tmp_path / "made").glob("*/report.json"))) == 3
    assert max(memory for _, memory in samples) > 100.0
