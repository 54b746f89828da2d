"""What is told about a line takes time in proportion to its length."""

from __future__ import annotations

import gc
import time
import weakref

import numpy as np
import pytest

from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.line.pieces import At
from tautwire.model.mesh import divide

SPANS = 1000


@pytest.mark.parametrize("share", [None, 0.5])
def test_thousand_spans_are_laid_out_at_once(share: float | None) -> None:
    """Pieces and mesh of 1000 spans take less than 5 s of CPU time, also where steady arms carry a
    share of the wire between the droppers beside them; each support looked through all droppers
    once, which took minutes."""
    closure = {} if share is None else {"supports.closure": "lift", "supports.share": share}
    case = load_case("ac-simple", {"line.spans": SPANS, **closure})
    begin = time.process_time()
    line = expand(case)
    mesh = divide(line, case.settings, case.scenario.speed)
    assert time.process_time() - begin < 5.0
    assert len(line.hangers) == 9 * SPANS
    assert mesh.node_count > 50 * SPANS


def test_line_of_a_case_is_kept_as_long_as_the_case() -> None:
    """The same case gives the same pieces; another case, though it may be equal, its own; nothing
    outlives its case."""
    case = load_case("ac-simple")
    line = weakref.ref(expand(case))
    assert expand(case) is line()
    assert expand(case.with_(**{"line.spans": 18})) is not line()
    assert expand(load_case("ac-simple")) is not line()
    del case
    gc.collect()
    assert line() is None


def test_node_at_a_place_is_the_nearest() -> None:
    """The node found at a place, also outside the wire and halfway between two, is the first of
    those that no other is nearer to."""
    case = load_case("ac-simple", {"line.spans": 3})
    strand = divide(expand(case), case.settings, case.scenario.speed).strand("contact")
    halfway = 0.5 * (strand.s[:-1] + strand.s[1:])
    random = np.random.default_rng(3).uniform(-5.0, strand.s[-1] + 5.0, 300)
    for place in [*strand.s, *halfway[:50], *random]:
        assert strand.position(place) == np.abs(strand.s - place).argmin()


def test_node_of_an_attachment_lies_there() -> None:
    """Every attachment has a node exactly at its place."""
    case = load_case("ac-simple", {"line.spans": 3})
    line = expand(case)
    mesh = divide(line, case.settings, case.scenario.speed)
    places: list[At] = [hanger.lower for hanger in line.hangers]
    assert np.array_equal(mesh.s[mesh.nodes(places)], [at.s for at in places])
