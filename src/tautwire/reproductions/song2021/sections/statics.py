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
from tautwire.reproductions.song2021.claims import Claim, Evidence, most, near
from tautwire.reproductions.song2021.passages import BASE
from tautwire.results.equilibrium import Equilibrium

FIXINGS = ("free", "fixed")
LOADS = (100.0, 200.0)
SPAN = 9
"""Span in the middle of the line whose elasticity is compared."""

ELASTICITY_WITHIN = 0.03
PRESAG_WITHIN = 0.005


@dataclass(frozen=True, eq=False)
class Statics:
    """Static results.

    Attributes
    ----------
    shape : Equilibrium
    support_x, dropper_x : sequences of m
    presag : tuple of float
        At the droppers of the middle span [mm].
    elasticity : mapping of str to tuple of float
        By reading: support and droppers 1 to 5 [mm/N].
    """

    shape: Equilibrium
    presag: tuple[float, ...]
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
    found: dict[str, tuple[float, ...]] = {}
    shape: Equilibrium | None = None
    presag: tuple[float, ...] = ()
    for fixing in FIXINGS:
        case = load_case(BASE, {**(changes or {}), "supports.messenger_longitudinal": fixing})
        span = min(SPAN, (case.line.spans + 1) // 2)
        case = case.with_(**{"settings.section": (span, span)})
        model = build(case)
        own = find_shape(model)
        if shape is None:
            shape, presag = own, _presag(own, span)
        for load in LOADS:
            data = elasticity(model, own, force=load)
            values = dict(zip(zip(data.span, data.kind, data.index, strict=True), data.elasticity,
                              strict=True))  # fmt: skip
            places = [("support", 0), *(("dropper", number) for number in range(1, 6))]
            found[reading(fixing, load)] = tuple(
                1e3 * float(values[span, kind, number]) for kind, number in places
            )
    assert shape is not None
    return Statics(shape, presag, found)


def _presag(shape: Equilibrium, span: int) -> tuple[float, ...]:
    """Return how far the droppers of a span lie below its supports [mm]."""
    left, right = shape.support_heights[span - 1], shape.support_heights[span]
    heights = shape.dropper_heights[shape.dropper_span == span]
    return tuple(1e3 * float(0.5 * (left + right) - height) for height in heights)


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
        Evidence("", f"pre-sag at dropper {number}", found, "mm", wanted - PRESAG_WITHIN,
                 wanted + PRESAG_WITHIN, wanted)
        for number, (found, wanted) in enumerate(
            zip(statics.presag, published.PRESAG, strict=True), 1
        )
    )  # fmt: skip
    places = ("support", *(f"dropper {number}" for number in range(1, 6)))
    own = tuple(
        near(name, f"elasticity at {place}", found, wanted, ELASTICITY_WITHIN, "mm/N")
        for name, values in statics.elasticity.items()
        for place, found, wanted in zip(places, values, published.ELASTICITY_PAPER, strict=True)
    )
    accepted = tuple(
        most(
            name,
            "largest deviation from the benchmark",
            largest_deviation(values, published.ELASTICITY_BENCHMARK),
            published.ACCEPTED_ELASTICITY_ERROR,
        )
        for name, values in statics.elasticity.items()
    )
    return [
        Claim("table-1-presag", "II.C", "The pre-sag is exactly that of the benchmark.", exact),
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
