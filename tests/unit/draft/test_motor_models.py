"""Which motors of the catalogue a name or a box stands for."""

import numpy as np

from stepbot.draft.evidence.motor_models import _named
from stepbot.sidecar.motors import body_size, catalogue_motor, motors_named_in


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
