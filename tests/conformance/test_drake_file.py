"""The file for Drake: its constraints replace the closures, without other changes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.lowering.rerooted_loops import reroot_loops
from stepbot.formats.rendering import render
from stepbot.robot.closures import loop_ways
from stepbot.robot.kinematics import link_poses
from tests.robots import ROBOTS

TAG = "{http://drake.mit.edu}ball_constraint"
LOOPS = tuple(name for name, build in ROBOTS.items() if build().closures)
POINTS = {"ball": 1, "revolute": 2, "fixed": 3}
"""Number of points that constrain each kind of closure."""


def _files(name: str) -> dict[str, bytes]:
    return render(ROBOTS[name](), "sdf", Diagnostics())


def _constraints(top: Any) -> list[tuple[str, list[float], str, list[float]]]:
    def point(held: Any, name: str) -> list[float]:
        return [float(word) for word in held.findtext(f"{TAG}_{name}").split()]

    return [
        (held.findtext(f"{TAG}_body_A"), point(held, "p_AP"), held.findtext(f"{TAG}_body_B"), point(held, "p_BQ"))
        for held in top.iter(TAG)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_constraints_hold_wherever_the_loops_close(name: str) -> None:
    """Both points of every constraint coincide over the whole range; their number depends on the kind of closure."""
    robot = reroot_loops(lower(ROBOTS[name](), FORMATS["sdf"], Diagnostics()))
    top = etree.fromstring(_files(name)[f"{robot.name}.drake.sdf"])
    constraints = _constraints(top)
    assert len(constraints) == sum(POINTS[closure.kind] for closure in robot.closures)
    for way in loop_ways(robot, 6):
        for q in way:
            X_W = link_poses(robot, q)
            for a, p_AP, b, p_BQ in constraints:
                np.testing.assert_allclose(X_W[a].apply(p_AP), X_W[b].apply(p_BQ), atol=1e-9)


@pytest.mark.parametrize("name", LOOPS)
def test_neither_file_holds_what_the_other_needs(name: str) -> None:
    """In Drake's file no link has two parent joints; files for other readers have no elements of Drake."""
    files = _files(name)
    drake, plain = (etree.fromstring(files[f"{ROBOTS[name]().name}{suffix}"]) for suffix in (".drake.sdf", ".sdf"))
    children = [joint.findtext("child") for joint in drake.iter("joint")]
    assert len(children) == len(set(children))
    assert not [element for element in plain.iter() if "drake" in str(element.tag)]


@pytest.mark.slow
def test_trees_have_no_file_for_drake() -> None:
    """A tree has no file for Drake, which would be a duplicate."""
    for name in ROBOTS:
        drake = [path for path in _files(name) if path.endswith(".drake.sdf")]
        assert bool(drake) is (name in LOOPS)


@pytest.mark.parametrize("name", LOOPS)
def test_drake_reads_it_strictly_and_keeps_the_loops_closed(name: str, tmp_path: Path) -> None:
    """Drake loads the file strictly without warnings; 0.2 s of falling open no loop beyond the solver's accuracy."""
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    multibody = pytest.importorskip("pydrake.multibody.plant")
    framework = pytest.importorskip("pydrake.systems.framework")
    analysis = pytest.importorskip("pydrake.systems.analysis")
    for path, content in _files(name).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_bytes(content)
    builder = framework.DiagramBuilder()
    plant, _ = multibody.AddMultibodyPlantSceneGraph(builder, 1e-3)
    plant.set_discrete_contact_approximation(multibody.DiscreteContactApproximation.kSap)
    parser = parsing.Parser(plant)
    parser.SetStrictParsing()
    file = tmp_path / f"{ROBOTS[name]().name}.drake.sdf"
    parser.AddModels(str(file))
    plant.Finalize()
    simulator = analysis.Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    simulator.AdvanceTo(0.2)
    constraints = _constraints(etree.parse(str(file)))
    assert plant.num_constraints() == len(constraints) > 0
    for a, p_AP, b, p_BQ in constraints:
        at_a, at_b = (
            plant.GetBodyByName(body).EvalPoseInWorld(context).multiply(np.array(point))
            for body, point in ((a, p_AP), (b, p_BQ))
        )
        np.testing.assert_allclose(at_a, at_b, atol=5e-5)
