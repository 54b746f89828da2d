"""Results become plain data field by field, in the units that their keys tell."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import pytest

from tautwire.plain import Plain, named, plain
from tautwire.results.statistics import LossClass, LossEvent


@dataclass(frozen=True)
class Blow(Plain):
    """A result with a renamed field, one left out, one derived, and one of its own kind."""

    derived: ClassVar[tuple[str, ...]] = ("energy",)
    untold: ClassVar[tuple[str, ...]] = ("history",)

    speed: float = field(metadata=named("speed_mm_s", 1e3))
    mass: float
    history: tuple[float, ...] = ()
    inner: Blow | None = None

    @property
    def energy(self) -> float:
        """Kinetic energy [J]."""
        return 0.5 * self.mass * self.speed**2


def test_fields_become_keys() -> None:
    """Keys name their units, nested results follow, what is not told is left out."""
    blow = Blow(2.0, 3.0, (1.0,), Blow(0.5, float("inf")))
    assert blow.as_dict() == {
        "speed_mm_s": 2000.0,
        "mass": 3.0,
        "inner": {"speed_mm_s": 500.0, "mass": None, "inner": None, "energy": None},
        "energy": 6.0,
    }


def test_arrays_and_numbers_that_are_not_finite() -> None:
    """NumPy values become Python ones, and JSON can be strict."""
    value = {"a": np.array([1.0, np.nan]), 2: (np.float64(np.inf), np.int64(3), True, "x", None)}
    assert plain(value) == {"a": [1.0, None], "2": [None, 3, True, "x", None]}
    assert json.loads(json.dumps(plain(value), allow_nan=False))["2"][1] == 3


@pytest.mark.parametrize(("high", "told"), [(0.002, 2.0), (float("inf"), None)])
def test_losses_in_milliseconds(high: float, told: float | None) -> None:
    """A loss and a class of losses tell their durations in milliseconds."""
    assert LossClass(0.001, high, 3).as_dict() == {"from_ms": 1.0, "to_ms": told, "count": 3}
    event = LossEvent(1.5, 0.004, 90.0, "dropper 3 of span 7", is_cut=True)
    assert event.as_dict() == {
        "start_s": 1.5,
        "duration_ms": 4.0,
        "position_m": 90.0,
        "place": "dropper 3 of span 7",
        "is_cut": True,
    }
