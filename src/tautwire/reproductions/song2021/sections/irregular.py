"""The passages of section V, as data: an irregular contact wire, and ways to step through time.

The uplift force is that of the ideal line at the same contact stiffness, so that within an
irregularity nothing differs but the time step.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tautwire.reproductions.song2021.passages import (
    HEIGHTS,
    ROUGH,
    SURFACE,
    TOP_SPEED,
    Reading,
    Scope,
    passage_study,
    standard,
    values_of,
)
from tautwire.specs.study import Study

MESH = 9
"""Nodes between adjacent droppers (NAD) of section V."""


def _surface(amplitude: str) -> Mapping[str, Any]:
    return {
        "irregularities.unevenness": [
            {"kind": "uniform", "spacing": "0.7 m", "amplitude": amplitude}
        ]
    }


IRREGULARITIES: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    HEIGHTS: (
        "heights ±2 mm",
        {
            "irregularities.installation": {
                "of": "height",
                "distribution": "uniform",
                "amplitude": "2 mm",
            }
        },
    ),
    SURFACE: ("surface ±1 mm", _surface("1 mm")),
    ROUGH: ("surface ±2 mm", _surface("2 mm")),
}
"""Readings of 'a set of random uniform number', of which the paper states neither place nor size:
name, words, values. Height errors beyond 3 mm would leave droppers slack at rest; 0.7 m is about an
element of the mesh; 2 mm make the uncalibrated reading lose contact about as often as the paper (16
times), 1 mm does so for the stiff plane one."""

COARSE, VARIABLE, FINE, ADAPTIVE, FINEST = "1ms", "variable", "0.2ms", "adaptive", "0.05ms"
WAVES = "+waves"
"""Ending of the names of steps that make up for the loss of wave speed by the step."""

_PLAIN = {"corrects_waves": False}
_VARIABLE = {"method": "variable", "gap_tolerance": "0.1 mm"}

STEPS: Mapping[str, Mapping[str, Any]] = {
    FINEST: {"settings.time_step": "0.05 ms"},
    COARSE: {},
    VARIABLE: {"settings.step_control": {**_VARIABLE, **_PLAIN}},
    FINE: {"settings.time_step": "0.2 ms"},
    ADAPTIVE: {"settings.step_control": "adaptive"},
    COARSE + WAVES: {"settings.step_control": {"corrects_waves": True}},
    VARIABLE + WAVES: {"settings.step_control": {**_VARIABLE, "corrects_waves": True}},
    FINE + WAVES: {
        "settings.time_step": "0.2 ms",
        "settings.step_control": {"corrects_waves": True},
    },
}
"""Ways to step by name, the longest computation first, for which no core should wait at the end:
values that differ from a constant step of 1 ms in the paper's plain scheme. The adaptive step
corrects wave speeds always; for 0.05 ms there is nothing to correct."""


def irregular(step: str, reading: Reading, kind: str, seed: int) -> str:
    """Return the name of a passage by way to step, reading, irregularity and seed."""
    return f"irregular-{kind}-{seed}-{step}-{reading.name}"


def irregular_passages(scope: Scope, uplift: Mapping[Reading, float]) -> dict[str, dict[str, Any]]:
    """List the passages of section V by name: the values that differ from the library case.

    Parameters
    ----------
    scope
        How much is wanted.
    uplift
        Uplift force of the ideal line by reading [N].
    """
    return {
        irregular(step, reading, kind, seed): {
            **values_of(MESH, reading, TOP_SPEED),
            "scenario.uplift_force": uplift[reading],
            "settings.seed": seed,
            **IRREGULARITIES[kind][1],
            **changes,
        }
        for reading, kind in scope.irregular
        if reading in uplift
        for seed in scope.seeds
        for step, changes in STEPS.items()
    }


def ideal(reading: Reading) -> str:
    """Return the name of the passage along the ideal line that section V starts from."""
    return standard(MESH, reading)


def irregular_study(
    scope: Scope, uplift: Mapping[Reading, float], changes: Mapping[str, Any] | None = None
) -> Study | None:
    """Make the study of section V; None when there is nothing to run.

    Parameters
    ----------
    scope
    uplift
        Uplift force by reading [N].
    changes
        Values replaced in all passages.
    """
    variants = irregular_passages(scope, uplift)
    return passage_study(variants, changes) if variants else None
