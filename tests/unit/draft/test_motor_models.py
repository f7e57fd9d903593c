"""Which motors of the catalogue a name or a box stands for."""

import numpy as np

from stepbot.draft.evidence.motor_models import _named, models
from stepbot.sidecar.motors import body_size, catalogue_motor, motors_named_in
from tests.assembled import assembled, part
from tests.solids import box


def test_a_name_that_several_variants_share_is_their_family() -> None:
    """The name of one model has no family; that of several is offered under the family's name."""
    variants = motors_named_in("STS3215_03a")
    edges = np.array(body_size(catalogue_motor(variants[0])))
    several = _named(variants, "STS3215_03a", edges, "its box")
    assert len(several.names) > 1
    assert several.family == "STS3215"
    assert ", which fits " in several.why
    (single,) = motors_named_in("xl430-w250-t")
    alone = _named((single,), "xl430-w250-t", np.array([0.001, 0.001, 0.001]), "its box")
    assert (alone.names, alone.family) == ((single,), "")
    assert alone.why.endswith(", unlike the catalogue's")


def test_a_box_of_the_size_of_a_motor_may_be_it() -> None:
    """A block without a name that is as large as a catalogue's motor, however it lies, and one that is 2 mm longer."""
    name = motors_named_in("xl430-w250-t")[0]
    x, y, z = (1e3 * size for size in body_size(catalogue_motor(name)))
    blocks = part("block", box(y, x, z)), part("longer", box(x + 2.0, y, z), 200)
    assembly = assembled(*blocks, is_meshed=True)
    found = models(assembly, "block")
    assert found is not None
    assert name in found.names
    assert found.why.startswith("by size alone")
    assert models(assembly, "longer") is None
