"""Verdicts on the numbers of drive tests, and the remedies of failed ones."""

from stepbot.diagnostics import Diagnostics
from stepbot.driving.judgement import Status, judge
from stepbot.driving.limits import demands
from stepbot.driving.results import Measure, Plot, Result


def test_the_remedy_of_an_open_loop_is_one_that_the_sidecar_allows() -> None:
    """Closures have the largest stiffness by default; a shorter time step makes them stiffer."""
    found = Diagnostics()
    result = Result("hold", (Measure("loop opening", 0.9, "pin"),), Plot("t", "mm", {}))
    (verdict,) = judge("mujoco", "arm.xml", [result], demands({}), found)
    assert verdict.status is Status.FAILED
    (one,) = found
    assert one.code == "SB830"
    assert "`simulation: {timestep:" in one.help[0]
