"""Section II.C, Table 1: pre-sag and elasticity, under the readings of what is not stated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tautwire.analyses.road.elasticity import elasticity
from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import (
    ALWAYS,
    Claim,
    Condition,
    Evidence,
    most,
    near,
)
from tautwire.reproductions.song2021.passages import BASE, NUMERICS
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

FIXINGS = ("free", "fixed")
LOADS = (100.0, 200.0)
"""Of Fig. 3 [N]."""
SPAN = 9
"""Span in the middle of the line whose elasticity is compared."""

ELASTICITY_WITHIN, PRESAG_WITHIN = 0.03, 0.005
"""Relative deviation from values read off a figure, and from a sag that is given in millimetres."""


@dataclass(frozen=True, eq=False)
class Statics:
    """Static results.

    Attributes
    ----------
    shape : Equilibrium
    presag : mapping of Condition to tuple of float
        Of the left support and the droppers of the middle span, below the nominal height of the
        contact wire [mm].
    elasticity : mapping of str to tuple of float
        By reading: support and droppers 1 to 5 [mm/N].
    """

    shape: Equilibrium
    presag: Mapping[Condition, tuple[float, ...]]
    elasticity: Mapping[str, tuple[float, ...]]


def reading(fixing: str, load: float) -> str:
    """Name a reading of the elasticity."""
    return f"messenger {fixing}, {load:g} N"


def compute_statics(changes: Mapping[str, Any] | None = None) -> Statics:
    """Find the static state, and the elasticity of the middle span under four readings.

    Parameters
    ----------
    changes
        Values of the case to replace, by path.
    """
    own = {**NUMERICS, **(changes or {})}
    cases = {
        fixing: load_case(BASE, {**own, "supports.messenger_longitudinal": fixing})
        for fixing in FIXINGS
    }
    every = {fixing: elasticities(case) for fixing, case in cases.items()}
    shape = every[FIXINGS[0]][0]
    found = {
        reading(fixing, load): values
        for fixing, (_, by_load) in every.items()
        for load, values in by_load.items()
    }
    held = load_case(BASE, {**own, "supports.closure": "height"})
    presag = {
        ALWAYS: _presag(cases[FIXINGS[0]], shape),
        Condition("contact wire held at its height", departs=True): _presag(
            held, find_shape(build(held))
        ),
    }
    return Statics(shape, presag, found)


def middle_span(case: Case) -> int:
    """Return the span whose elasticity is compared."""
    return min(SPAN, (case.line.spans + 1) // 2)


def elasticities(case: Case) -> tuple[Equilibrium, dict[float, tuple[float, ...]]]:
    """Return the shape of a line, and the elasticity of its middle span by load [N].

    Parameters
    ----------
    case

    Returns
    -------
    shape : Equilibrium
    elasticity : mapping of float to tuple of float
        At the support and droppers 1 to 5 [mm/N].
    """
    span = middle_span(case)
    model = build(case.with_(**{"settings.section": (span, span)}))
    shape = find_shape(model)
    places = [("support", 0), *(("dropper", number) for number in range(1, 6))]
    found: dict[float, tuple[float, ...]] = {}
    for load in LOADS:
        data = elasticity(model, shape, force=load)
        keys = zip(data.span, data.kind, data.index, strict=True)
        values = dict(zip(keys, data.elasticity, strict=True))
        found[load] = tuple(1e3 * float(values[span, *place]) for place in places)
    return shape, found


def _condition(name: str) -> Condition:
    """Return the condition of a reading; the library's is the first."""
    return Condition(name, name != reading(FIXINGS[0], LOADS[0]))


def _presag(case: Case, shape: Equilibrium) -> tuple[float, ...]:
    """Return how far left support and droppers of a span lie below the nominal height [mm]."""
    span = middle_span(case)
    nominal = case.supports.contact_heights(case.line.spans + 1)[span - 1]
    heights = [shape.support_heights[span - 1], *shape.dropper_heights[shape.dropper_span == span]]
    return tuple(1e3 * float(nominal - height) for height in heights)


def largest_deviation(values: tuple[float, ...], wanted: tuple[float, ...]) -> float:
    """Return the largest relative deviation [%]."""
    return max(100.0 * abs(a / b - 1.0) for a, b in zip(values, wanted, strict=True))


def claims(statics: Statics) -> list[Claim]:
    """Judge what section II.C says about the static state.

    Parameters
    ----------
    statics
    """
    exact = tuple(
        Evidence(condition, f"pre-sag at {f'dropper {number}' if number else 'the support'}", found,
                 "mm", wanted - PRESAG_WITHIN, wanted + PRESAG_WITHIN, wanted)
        for condition, values in statics.presag.items()
        for number, (found, wanted) in enumerate(
            zip(values, (0.0, *published.PRESAG), strict=True)
        )
    )  # fmt: skip
    places = ("support", *(f"dropper {number}" for number in range(1, 6)))
    own = tuple(
        near(_condition(name), f"elasticity at {place}", found, wanted, ELASTICITY_WITHIN, "mm/N")
        for name, values in statics.elasticity.items()
        for place, found, wanted in zip(places, values, published.ELASTICITY_PAPER, strict=True)
    )
    accepted = tuple(
        most(
            _condition(name),
            "largest deviation from the benchmark",
            largest_deviation(values, published.ELASTICITY_BENCHMARK),
            published.ACCEPTED_ELASTICITY_ERROR,
        )
        for name, values in statics.elasticity.items()
    )
    return [
        Claim(
            "table-1-presag",
            "II.C",
            "The pre-sag is exactly that of the benchmark.",
            exact,
            "Droppers are hung at their pre-sag; an arm at exactly 10° lets the wire lie lower at "
            "the support than one that is placed for pre-sag 0 there (10.8°).",
        ),
        Claim(
            "table-1-elasticity",
            "II.C",
            "Elasticity at supports and droppers, the paper's column of Table 1 "
            f"(limit here: within {100 * ELASTICITY_WITHIN:g} % at every point).",
            own,
            "The force, and whether supports hold the messenger wire along the track (fixed or "
            "free), are not stated.",
        ),
        Claim(
            "table-1-benchmark",
            "II.C",
            "The elasticity deviates from the benchmark by less than 10 % "
            f"(the paper: at most {published.LARGEST_ELASTICITY_ERROR} %).",
            accepted,
        ),
    ]
