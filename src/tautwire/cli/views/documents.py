"""The JSON documents of ``static`` and ``run``: stable keys, units in their names.

Spans, droppers and supports are numbered from 1. What is not a number is null.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from tautwire.analyses.road.dynamics import integrator_of
from tautwire.assessment.checks import Check
from tautwire.report.parts.fitting_words import bodies_of, body_heights, stay_state, stays_of
from tautwire.results.accuracy import Accuracy, rounded
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.run import Run
from tautwire.results.statistics import RunStatistics
from tautwire.specs.case import Case
from tautwire.specs.line.irregularity import Irregularities
from tautwire.version import __version__

COST = (
    "dof",
    "steps",
    "iterations_mean",
    "simulated_s",
    "cpu_s",
    "wall_s",
    "real_time_factor",
    "tuning_passes",
)

_FORCES = {
    "mean_n": "mean",
    "max_n": "maximum",
    "min_n": "minimum",
    "statistical_max_n": "statistical_maximum",
    "statistical_min_n": "statistical_minimum",
}
"""Statistics that have an error bar, by their key."""


def conventions(case: Case, backend: str, run: Run | None = None) -> dict[str, Any]:
    """Return the choices without which two results cannot be compared.

    Parameters
    ----------
    case : Case
    backend : str
        Kernels in use.
    run : Run, optional
        What was computed; without it the choices of the case are named.
    """
    settings = case.settings
    used = {} if run is None else run.counters
    condition = case.chosen_condition
    return {
        "condition": None if condition is None else [condition.name, *condition.told()],
        "closure": case.supports.closure,
        "ends": _ends(case),
        "arm_motion": None if case.supports.closure == "spring" else case.supports.arm.motion,
        "messenger_longitudinal": case.supports.messenger_longitudinal,
        "mesh": settings.mesh(),
        "band_hz": settings.band,
        "nodes_between_droppers": settings.nodes_between_droppers,
        "time_step_s": settings.step(),
        "step_control": used.get("step_control", settings.step_control.method),
        "integrator": used.get("integrator", integrator_of(case).describe()),
        "backend": backend,
        "damping": {
            "mass_1_per_s": case.line.damping.mass,
            "stiffness_s": case.line.damping.stiffness,
        },
        "filter_order": settings.filter_order,
        "headline_filter": settings.filter,
        "is_irregular": case.irregularities != Irregularities(),
        "seed": settings.seed,
    }


def _ends(case: Case) -> Any:
    """Return how wires end: a word or a device for both ends, or one for each."""
    ends = case.line.ends.to_dict()
    return ends["left"] if ends["left"] == ends["right"] else ends


def static_document(
    case: Case,
    shape: Equilibrium,
    elasticity: Elasticity | None,
    backend: str,
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the document of ``static``.

    Parameters
    ----------
    case : Case
    shape : Equilibrium
    elasticity : Elasticity or None
        None when its computation was stopped.
    backend : str
    warnings : sequence of str
    """
    return {
        "case": case.name,
        "version": __version__,
        "status": "partial" if elasticity is None else "done",
        "conventions": conventions(case, backend),
        "warnings": list(warnings),
        "shape": shape_part(case, shape),
        "elasticity": None if elasticity is None else elasticity_part(elasticity),
        "case_hash": case.hash(),
    }


def shape_part(case: Case, shape: Equilibrium) -> dict[str, Any]:
    """Return the static state: droppers per span, supports from left to right."""
    spans = range(1, case.line.spans + 1)

    def by_span(values: Any) -> list[list[float]]:
        return [values[shape.dropper_span == span].tolist() for span in spans]

    return {
        "iterations": shape.iterations,
        "residual_n": shape.residual,
        "weight_n": shape.weight,
        "bodies": [
            {
                "name": body.name,
                "wire": body.run,
                "start_m": body.start,
                "end_m": body.end,
                "heights_m": list(body_heights(shape, body)),
            }
            for body in bodies_of(case)
        ],
        "stays": [
            {
                "name": stay.name,
                "wire": stay.at.run,
                "x_m": stay.at.s,
                "force_n": stay_state(shape, stay)[1],
            }
            for stay in stays_of(case)
        ],
        "reaction_n": shape.reaction,
        "dropper_positions_m": by_span(shape.dropper_x),
        "dropper_lengths_unstrained_m": by_span(shape.dropper_lengths_unstrained),
        "dropper_lengths_m": by_span(shape.dropper_lengths),
        "dropper_forces_n": by_span(shape.dropper_forces),
        "dropper_heights_m": by_span(shape.dropper_heights),
        "support_positions_m": shape.mast_x.tolist(),
        "support_heights_m": shape.support_heights.tolist(),
        "arm_supports": shape.support_number[shape.arm_supports - 1].tolist(),
        "arm_forces_n": shape.arm_forces.tolist(),
        "arm_angles_deg": np.degrees(shape.arm_angles).tolist(),
        "arm_ends_m": shape.arm_ends.tolist(),
    }


def elasticity_part(elasticity: Elasticity) -> dict[str, Any]:
    """Return the elasticity, one entry per point."""
    points = zip(
        elasticity.span.tolist(),
        elasticity.kind,
        elasticity.index.tolist(),
        elasticity.x.tolist(),
        elasticity.elasticity.tolist(),
        strict=True,
    )
    return {
        "force_n": elasticity.force,
        "nonuniformity_percent": 100.0 * elasticity.nonuniformity,
        "points": [
            {"span": span, "kind": kind, "index": index, "x_m": x, "elasticity_mm_per_n": 1e3 * e}
            for span, kind, index, x, e in points
        ],
    }


def _leave_out_worthless_digits(
    numbers: dict[str, Any], statistics: RunStatistics, accuracy: Accuracy
) -> None:
    """Round the statistics that have an error bar, in place."""
    for told, entry in zip(numbers["pantographs"], statistics.pantographs, strict=True):
        _round(told["contact_loss"], "percent", accuracy.of(entry.name, "loss"))
        for kind, part in entry.filtered.items():
            names = _FORCES | {f"std_{band}_n": band for band in part.standard_deviations}
            for key, name in names.items():
                _round(told[kind], key, accuracy.of(entry.name, kind, name))
    _round(numbers["uplift"], "max_mm", 1e3 * accuracy.of("uplift"))


def _round(numbers: dict[str, Any], key: str, error: float) -> None:
    if numbers[key] is not None:
        numbers[key] = rounded(numbers[key], error)


def run_document(
    run: Run,
    statistics: RunStatistics,
    checks: Iterable[Check],
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the document of ``run``.

    Parameters
    ----------
    run : Run
    statistics : RunStatistics
    checks : iterable of Check
    warnings : sequence of str
    """
    case, numbers = run.case, statistics.as_dict()
    if run.accuracy is not None:
        _leave_out_worthless_digits(numbers, statistics, run.accuracy)
    backend = str(run.counters.get("backend", case.settings.backend))
    return {
        "case": case.name,
        "project": case.project.rows(),
        "version": __version__,
        "status": run.status,
        "message": run.message,
        "conventions": conventions(case, backend, run),
        "warnings": list(warnings),
        "speed_kmh": round(3.6 * case.scenario.speed, 9),
        "direction": case.scenario.direction,
        "contact_stiffness_n_per_m": case.settings.contact_stiffness,
        "section": numbers["section"],
        "pantographs": numbers["pantographs"],
        "uplift": numbers["uplift"],
        "droppers": numbers["droppers"],
        "numerical_error": None if run.accuracy is None else run.accuracy.as_dict(),
        "cost": {key: run.counters.get(key) for key in COST},
        "checks": [
            {**check.as_dict(), "value": rounded(check.value, check.error)} for check in checks
        ],
        "provenance": dict(run.provenance),
    }
