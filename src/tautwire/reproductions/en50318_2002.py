"""EN 50318:2002: the reference model of the standard at 250 and 300 km/h.

The standard's ranges are those two secondary sources print; its filter is not stated by them.
So every number is judged with both filters of this program.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.dynamics import Progress
from tautwire.analyses.road.pipeline import run_case
from tautwire.assessment.references import compare_with_reference, load_references
from tautwire.inputs.load import load_case
from tautwire.reproductions.record import DOUBTFUL, Claim, Record, claims_of
from tautwire.results.run import Run

STUDY = "en50318-2002"
SPEEDS = (250, 300)
"""Speeds of the standard [km/h]."""

Watch = Callable[[str, Progress], bool]


def reproduce(watch: Watch | None = None, changes: Mapping[str, Any] | None = None) -> Record:
    """Run the reference model at both speeds and judge every published range.

    Parameters
    ----------
    watch
        Called with the name of the run (``"250 km/h"``) and its progress; True stops the study.
    changes
        Inputs to replace, by path, to see what an input is worth; the record names them.

    Returns
    -------
    Record
        With status ``"partial"`` and the complete runs only, when it was stopped.

    Raises
    ------
    ConvergenceError
        When a passage fails.
    """
    runs: dict[str, Run] = {}
    claims: list[Claim] = []
    filters: dict[str, str] = {}
    status = "done"
    for speed in SPEEDS:
        name = f"{speed} km/h"
        run = _run(name, watch, changes or {})
        if run.status != "done":
            status = "partial"
            break
        runs[name] = run
        own, filters = _judge(name, run, speed)
        claims += own
    case = load_case(STUDY)
    references = [load_references().get(f"{STUDY}-{speed}") for speed in SPEEDS]
    return Record(
        study=STUDY,
        title=case.title,
        status=status,
        source="; ".join(dict.fromkeys(reference.source for reference in references)),
        published_filter="; ".join(dict.fromkeys(reference.filter for reference in references)),
        filters=filters,
        claims=tuple(claims),
        doubtful_inputs=tuple(s for s in case.sources if s.confidence in DOUBTFUL),
        changed_inputs=tuple(changes or {}),
        runs=runs,
    )


def _run(name: str, watch: Watch | None, changes: Mapping[str, Any]) -> Run:
    case = load_case(STUDY, {**changes, "scenario.speed": name})
    return run_case(case, watch=None if watch is None else lambda _, p: watch(name, p))


def _judge(name: str, run: Run, speed: int) -> tuple[tuple[Claim, ...], dict[str, str]]:
    """Return the claims about one run, and the filters it was seen through."""
    reference = load_references().get(f"{STUDY}-{speed}")
    first, last = run.case.with_(**{"settings.section": None}).resolved_section()
    own, wider = contact_statistics(run), contact_statistics(run, section=(first, last))
    filtered = own.pantograph().filtered
    rows, others = (
        {kind: compare_with_reference(part, reference, filter=kind) for kind in filtered}
        for part in (own, wider)
    )
    claims = claims_of(name, rows, others, f"spans {first} to {last}")
    return claims, {kind: part.description for kind, part in filtered.items()}
