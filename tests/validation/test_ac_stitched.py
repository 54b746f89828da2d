"""AC stitched against the figure of EN 50318:2018, as digitised from a public preview."""

from __future__ import annotations

import numpy as np
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.results.equilibrium import Equilibrium


@pytest.fixture(scope="module")
def shape() -> Equilibrium:
    return find_shape(build(load_case("ac-stitched")))


def test_dropper_lengths(shape: Equilibrium) -> None:
    """Dropper lengths agree with the digitised 1.345, 1.349, 1.217 and 1.177 m within 10 mm, the
    accuracy of the digitising."""
    own = shape.dropper_span == 9
    lengths = shape.dropper_lengths[own]
    assert lengths[:4] == pytest.approx([1.345, 1.349, 1.217, 1.177], abs=0.010)
    assert lengths == pytest.approx(lengths[::-1], abs=1e-4)


def test_messenger_and_stitch_wire(shape: Equilibrium) -> None:
    """Messenger wire at the clamp and stitch wire at the support lie 1.461 and 1.336 m above the
    contact wire as digitised, within 10 mm."""
    support, level = 8 * 65.0, 5.08
    messenger, stitch = shape.wire("messenger"), shape.wire("stitch 9")
    at_clamp = np.interp(support + 9.0, messenger.s, messenger.position[:, 2])
    at_support = np.interp(support, stitch.s, stitch.position[:, 2])
    assert at_clamp - level == pytest.approx(1.461, abs=0.010)
    assert at_support - level == pytest.approx(1.336, abs=0.010)
