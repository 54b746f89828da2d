"""The mesh that follows from the band: what halving all of its elements changes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.pipeline import run_case
from tautwire.inputs.load import load_case
from tautwire.model.mesh import Division
from tautwire.results.statistics import PantographStatistics

Array = NDArray[np.float64]
SHARE, LOSSES = 0.03, 1
"""What may change: a share of the standard deviation, and a number of losses of contact."""
LINES: dict[str, tuple[str, dict[str, Any]]] = {
    "reference line": ("ac-simple", {"line.spans": 9, "settings.section": [3, 6]}),
    "arms that act vertically, losses": (
        "ac-simple-plane", {"line.spans": 9, "settings.section": [3, 6]},
    ),
    "contact wire alone": ("tram", {}),
    "wide gaps, low tension": (
        "ac-simple",
        {
            "line.spans": 9, "line.span_length": 60.0, "settings.section": [3, 6],
            "wires.contact.tension": 10e3, "wires.messenger.tension": 10e3,
            "droppers.positions": [5, 17.5, 30, 42.5, 55], "droppers.presag": [0.0] * 5,
            "supports.closure": "lift", "scenario.speed": "160 km/h",
        },
    ),
}  # fmt: skip


def passage(name: str, changes: dict[str, Any]) -> PantographStatistics:
    run = run_case(load_case(name, changes))
    assert run.status == "done"
    return contact_statistics(run).pantograph()


@pytest.mark.slow
@pytest.mark.parametrize("line", LINES)
def test_halved_elements_change_little(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """σ(0-200 Hz) changes by less than 3 % and the losses of contact by at most one, under the same
    mean force; published lines at their whole lengths are in the table of the page on theory."""
    name, changes = LINES[line]
    automatic = passage(name, changes)
    fractions = Division.fractions

    def halved(self: Division, gap: float) -> Array:
        left = fractions(self, gap)
        middle = 0.5 * (left + np.append(left[1:], 1.0))
        return np.stack([left, middle], axis=1).ravel()

    monkeypatch.setattr(Division, "fractions", halved)
    fine = passage(name, changes)
    own, other = (one.sharp.standard_deviations["0_200"] for one in (automatic, fine))
    assert own == pytest.approx(other, rel=SHARE)
    assert own != other  # the mesh is another one
    assert automatic.sharp.mean == pytest.approx(fine.sharp.mean, abs=0.5)
    assert abs(automatic.contact_loss.count - fine.contact_loss.count) <= LOSSES
