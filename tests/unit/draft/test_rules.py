"""Rules of evidence are found because they are in the package, and come in their order."""

import sys
from pathlib import Path

import pytest

from stepbot.draft import evidence
from tests.assembled import Node, inferred, part
from tests.solids import box

RULE = '''
from stepbot.draft.evidence import rule

@rule({order})
def magnet_evidence(survey, evidence):
    """Magnets hold what they are named after."""
    a, b = (i for i, one in survey.parts.items() if "magnet" in one.path)
    assert bool(evidence.welds) == {is_late}
    evidence.weld(0.9, a, b, "magnets")
'''


@pytest.mark.parametrize(("order", "is_late"), [(1, False), (85, True)])
def test_a_module_in_the_package_is_a_rule(
    order: int, is_late: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without an edit elsewhere; here before and after the rules that weld two plates which touch."""
    nodes: list[Node] = [part("magnet", box(10, 10, 10)), part("second magnet", box(10, 10, 10), z=15)]
    nodes += [part("plate", box(200, 200, 10), z=-60), part("other plate", box(100, 100, 10), z=-50)]
    assert "magnets" not in {weld.why for weld in inferred(*nodes).welds}
    (tmp_path / "magnets.py").write_text(RULE.format(order=order, is_late=is_late), encoding="utf-8")
    monkeypatch.setattr(evidence, "__path__", [*evidence.__path__, str(tmp_path)])
    monkeypatch.setattr(evidence, "_RULES", [*evidence._RULES])
    try:
        assert "magnets" in {weld.why for weld in inferred(*nodes).welds}
    finally:
        del sys.modules["stepbot.draft.evidence.magnets"]
