"""Revisions of real assemblies: one published twice, and exports of the kernel with other names.

The corpus has no revisions of one assembly in which parts were moved, added or removed. It has the as1 assembly twice,
with and without materials.
"""

from collections import Counter
from pathlib import Path

import pytest

from robot_library.moments import pose
from stepbot import inspect
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.differences import differing_steps
from stepbot.revisions.differences import Difference
from stepbot.runtime.cache import Cache
from tests.revisions import Revision

pytestmark = pytest.mark.slow


def differences(old: Path, new: Path, folder: Path) -> tuple[Difference, ...]:
    """Rows of `stepbot diff` except materials, some of which the kernel's export loses."""
    from stepbot.diagnostics import Diagnostics

    diagnostics = Diagnostics()
    compared = differing_steps(old, new, Options(output=Path(), cache=Cache(folder / "cache")), diagnostics)
    assert compared is not None, list(map(str, diagnostics))
    return compared.rows


def test_assembly_with_and_without_materials(corpus: Path, tmp_path: Path) -> None:
    """The second as1 differs in materials only: six bolts, two brackets and the plate."""
    rows = differences(corpus / "as1-oc-214.step", corpus / "as1-oc-214-mat.step", tmp_path)
    assert {row.kind for row in rows} == {"material"}
    counts = Counter(row.detail for row in rows)
    assert counts == {"material '' -> 'STEEL'": 6, "material '' -> 'ALUMINIUM'": 2, "material '' -> 'BRONZE'": 1}


@pytest.mark.parametrize(
    "name", ["as1-oc-214.step", pytest.param("low_cost_robot_follower.step", marks=pytest.mark.long)]
)
def test_every_name_changed(name: str, corpus: Path, tmp_path: Path) -> None:
    """With every product and occurrence renamed, each part is matched by its shape and pose, equal parts too."""
    revised = Revision(corpus / name).rename_all(lambda old: f"X{old[::-1]}" if old else old)
    rows = differences(corpus / name, revised.write(tmp_path / "new.step"), tmp_path)
    assert {row.kind for row in rows} - {"material"} == {"renamed"}


def test_three_changes_among_other_names(corpus: Path, tmp_path: Path) -> None:
    """A moved rod, a removed nut, and a renamed and copied plate are one row each, plus the rows of renamed parts."""
    source = corpus / "as1-oc-214.step"
    revised = Revision(source).rename({"plate": "Grundplatte"}).move("rod_1", pose((0, 0, 4.0)))
    revised.remove("nut_1").copy("plate_1", "plate_2", pose((0, 0, 200.0)))
    rows = differences(source, revised.write(tmp_path / "new.step"), tmp_path)
    found = {(row.kind, row.name, row.new_name) for row in rows if row.kind != "material"}
    assert found == {
        ("renamed", "plate", "plate_1"),
        ("added", "plate_2", ""),
        ("moved", "rod-assembly/rod", ""),
        ("removed", "rod-assembly/nut_1", ""),
        ("renamed", "rod-assembly/nut_2", "rod-assembly/nut"),
    }


def test_export_anew_has_no_differences(corpus: Path, tmp_path: Path) -> None:
    """The kernel's export of a real arm has other entity numbers and faces, and equal fingerprints."""
    source = corpus / "two_joint_servo_arm_ap242.step"
    again = Revision(source).write(tmp_path / "again.step")
    assert inspect(again, cache=tmp_path / "cache").assembly is not None
    assert {row.kind for row in differences(source, again, tmp_path)} <= {"material"}
