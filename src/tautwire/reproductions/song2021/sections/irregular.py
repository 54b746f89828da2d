"""The passages of section V, as data: an irregular contact wire, and ways to step through time.

The uplift force is that of the ideal line at the same contact stiffness, so that within an
irregularity nothing differs but the time step.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tautwire.reproductions.song2021.passages import (
    HEIGHTS,
    SURFACE,
    TOP_SPEED,
    Scope,
    passage_study,
    standard,
    values_of,
)
from tautwire.specs.study import Study

SEED = 2021

MESH = 9
"""Nodes between adjacent droppers (NAD) of section V."""

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
    SURFACE: (
        "surface ±1 mm",
        {
            "irregularities.unevenness": [
                {"kind": "uniform", "spacing": "0.7 m", "amplitude": "1 mm"}
            ]
        },
    ),
}
"""The two readings of 'a set of random uniform number', of which the paper states neither place nor
size: name, words, values. Height errors beyond 3 mm would leave droppers slack at rest; 0.7 m is
about an element of the mesh."""

COARSE, VARIABLE, FINE, ADAPTIVE, FINEST = "1ms", "variable", "0.2ms", "adaptive", "0.05ms"

STEPS: Mapping[str, Mapping[str, Any]] = {
    COARSE: {},
    VARIABLE: {"settings.step_control": {"method": "variable", "gap_tolerance": "0.1 mm"}},
    FINE: {"settings.time_step": "0.2 ms"},
    ADAPTIVE: {"settings.step_control": "adaptive"},
    FINEST: {"settings.time_step": "0.05 ms"},
}
"""Ways to step by name: values that differ from a constant step of 1 ms."""


def irregular(step: str, stiffness: int, kind: str) -> str:
    """Return the name of a passage by way to step, contact stiffness [kN/m] and irregularity."""
    return f"irregular-{kind}-{step}-k{stiffness}"


def irregular_passages(scope: Scope, uplift: Mapping[int, float]) -> dict[str, dict[str, Any]]:
    """List the passages of section V by name: the values that differ from the library case.

    Parameters
    ----------
    scope
        How much is wanted.
    uplift
        Uplift force of the ideal line by contact stiffness [kN/m] [N].
    """
    found: dict[str, dict[str, Any]] = {}
    for stiffness in scope.irregular:
        if stiffness not in uplift:
            continue
        shared = {
            **values_of(MESH, stiffness, TOP_SPEED),
            "scenario.uplift_force": uplift[stiffness],
            "settings.seed": SEED,
        }
        for kind in scope.kinds:
            for step, changes in STEPS.items():
                found[irregular(step, stiffness, kind)] = {
                    **shared,
                    **IRREGULARITIES[kind][1],
                    **changes,
                }
    return found


def ideal(stiffness: int) -> str:
    """Return the name of the passage along the ideal line that section V starts from."""
    return standard(MESH, stiffness)


def irregular_study(
    scope: Scope, uplift: Mapping[int, float], changes: Mapping[str, Any] | None = None
) -> Study | None:
    """Make the study of section V; None when there is nothing to run.

    Parameters
    ----------
    scope
    uplift
        Uplift force by contact stiffness [kN/m] [N].
    changes
        Values replaced in all passages.
    """
    variants = irregular_passages(scope, uplift)
    return passage_study(variants, changes) if variants else None
