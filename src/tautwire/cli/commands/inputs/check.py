"""``check``: every input error at once, wave quantities and advice; the passage is not computed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from tautwire.analyses.design.conditions import examine, state_of
from tautwire.analyses.road.shape import find_shape
from tautwire.assessment.design.checks import DesignCheck, design_checks
from tautwire.assessment.design.lateral import known_gauge
from tautwire.assessment.limits import limits_of
from tautwire.assessment.wave_quantities import WaveQuantity, wave_quantities
from tautwire.cli.about import computation, program
from tautwire.cli.session import REFUSED, Answer
from tautwire.cli.views.design_view import checks_view
from tautwire.cli.views.mapping_view import announce_tables
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import ConvergenceError, ModelError
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.model.plausibility import implausible_inputs, implausible_shape
from tautwire.model.preflight import Advice, preflight
from tautwire.model.resolution import Size, size
from tautwire.report.parts.words import speed
from tautwire.specs.case import Case
from tautwire.version import __version__

COARSE_BAND = 20.0
"""Band of the mesh on which the static state is sought [Hz]: graded, it gives dropper forces as the
fine one does, at a tenth of the cost."""


def check_case(answer: Answer, reference: str, overrides: Sequence[str]) -> None:
    """Check a case and show what it amounts to."""
    announce_tables(answer, reference)
    case = load_case(reference, overrides)
    answer.say(program(case.settings.backend))
    known_gauge(case.requirements.gauge)
    limits_of(case)
    quantities, amount = wave_quantities(case), size(case)
    advice, design = _examined(case)
    answer.document.update(
        {
            "case": case.name,
            "version": __version__,
            "case_hash": case.hash(),
            "valid": True,
            "warnings": [str(item) for item in advice],
            "advice": [item.as_dict() for item in advice],
            "wave_quantities": [quantity.as_dict() for quantity in quantities],
            "section": dict(zip(("first_span", "last_span"), case.resolved_section(), strict=True)),
            "size": amount.as_dict(),
            "design_checks": [one.as_dict() for one in design],
            "taken_over": _taken_over(case),
        }
    )
    refused = [str(item) for item in advice if item.severity == "refused"]
    if refused:
        answer.document["valid"] = False
        answer.fail("model", refused, REFUSED)
        return
    answer.show(heading(case.title or case.name, "input accepted"), _summary(case, amount))
    answer.show(heading("Wave quantities"), _wave_table(quantities))
    answer.show(*checks_view(design))
    answer.show(heading("Advice"), *_advice_view(advice))
    for template, paths in _taken_over(case).items():
        answer.show(heading(f"From {template}, not checked for your line"), ", ".join(paths))


def _examined(case: Case) -> tuple[list[Advice], tuple[DesignCheck, ...]]:
    """Return all advice, and the checks of the design, on states found on a coarse mesh."""
    found = [*preflight(case), *implausible_inputs(case)]
    coarse = {"band": COARSE_BAND, "nodes_between_droppers": None, "longest_element": None}
    sketch = case.with_(settings=case.settings.with_(**coarse, graded_mesh=None))
    try:
        model = build(sketch)
        shape = find_shape(model)
    except ModelError as error:
        return [*found, Advice("static state", "refused", str(error), "see above")], ()
    except ConvergenceError as error:
        return [*found, Advice("static state", "warning", str(error), "see 'tautwire static'")], ()
    states = [state_of(model, shape, None)]
    if case.condition is None:
        names = [one.name for one in case.conditions]
        states += [examine(model, shape, name, with_elasticity=False) for name in names]
    faults = [
        Advice(f"condition {one.name!r}", "warning", one.fault, "see 'tautwire static'")
        for one in states
        if one.fault
    ]
    advice = [*found, *implausible_shape(case, shape), *faults]
    return advice, design_checks(model, states)


def _taken_over(case: Case) -> dict[str, list[str]]:
    """Return the values taken over from a template, by its name."""
    taken: dict[str, list[str]] = {}
    for source in case.sources:
        if source.template:
            taken.setdefault(source.template, []).append(source.path)
    return taken


def _summary(case: Case, amount: Size) -> Any:
    first, last = case.resolved_section()
    target, scenario = case.scenario.target_mean_force(), case.scenario
    forces = ", ".join(f"{force:.1f} N" for force in case.uplift_forces())
    return facts(
        [
            ("line", f"{case.line.spans} spans, {case.line.length():g} m"),
            ("droppers", str(amount.droppers)),
            ("section", f"spans {first} to {last}"),
            ("speed", f"{speed(scenario.speed)}, running {scenario.direction}"),
            ("pantographs", ", ".join(entry.name for entry in case.pantographs)),
            ("uplift force", forces if target is None
             else f"tuned to a mean of {target:.2f} N, first guess {forces}"),
            ("computation", computation(amount, case.settings.backend)),
        ]
    )  # fmt: skip


def _wave_table(quantities: Sequence[WaveQuantity]) -> Any:
    rows = [(item.name, _value(item), item.formula) for item in quantities]
    return table(("", "", "formula"), "LrL", rows)


def _value(item: WaveQuantity) -> str:
    if not math.isfinite(item.value):
        return "–"
    if item.unit == "m/s":
        return f"{item.value:.2f} m/s = {3.6 * item.value:.1f} km/h"
    if item.unit == "m/N":
        return f"{1e3 * item.value:.3f} mm/N"
    return f"{item.value:.3f}" if item.unit == "1" else f"{item.value:.2f} {item.unit}"


def _advice_view(advice: Sequence[Advice]) -> list[Any]:
    if not advice:
        return ["nothing to say: mesh, time step, line and speed suit each other"]
    rows = [(item.severity, item.topic, f"{item.text}.\n{item.cure}.") for item in advice]
    return [table(("", "", ""), "llL", rows)]
