"""``report`` and ``compare``: what is done with stored runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautwire.assessment.checks import Criteria
from tautwire.assessment.measurement import (
    MeasurementComparison,
    MeasurementRow,
    compare_with_measurement,
)
from tautwire.cli.session import Answer
from tautwire.cli.views.run_view import QUANTITIES
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.measured import read_measured
from tautwire.report.parts.words import MISSING, number, readable
from tautwire.results.run import Run
from tautwire.results.storage import load_elasticity, load_run
from tautwire.text import csv_text
from tautwire.units import UnitError, parse_quantity
from tautwire.version import __version__


def report_runs(answer: Answer, paths: Sequence[Path], out: Path, criteria: Criteria) -> None:
    """Write the report of one run, or of several overlaid."""
    from tautwire.report.pages.run_page import write_report

    _refuse_unwritable(out)
    runs = load_runs(paths)
    written = write_report(
        runs,
        out,
        [load_elasticity(path) for path in paths],
        criteria=criteria,
    )
    answer.document.update(
        {
            "version": __version__,
            "file": str(written),
            "runs": [
                {
                    "file": str(path),
                    "case": run.case.name,
                    "status": run.status,
                    "speed_kmh": round(3.6 * run.case.scenario.speed, 9),
                }
                for path, run in zip(paths, runs, strict=True)
            ],
        }
    )
    answer.show(f"{written} written")


def load_runs(paths: Sequence[Path]) -> list[Run]:
    """Load stored runs.

    Raises
    ------
    InputError
        With every file that cannot be used.
    """
    problems: list[str] = []
    runs: list[Run] = []
    for path in paths:
        try:
            runs.append(load_run(path))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return runs


@dataclass(frozen=True)
class Measurement:
    """A measured run as the user gives it.

    Attributes
    ----------
    path : Path
    pantograph : str or None
    offset : str
    is_filtered : bool
    """

    path: Path
    pantograph: str | None
    offset: str
    is_filtered: bool


def compare_run(answer: Answer, path: Path, wanted: Measurement, out: Path | None) -> None:
    """Compare a stored run with a measured one."""
    try:
        offset = parse_quantity(wanted.offset, "m")
    except UnitError as error:
        raise InputError(f"--offset: {error}") from None
    if out is not None:
        _refuse_unwritable(out)
    run, measured = load_run(path), read_measured(wanted.path)
    compared = compare_with_measurement(
        run,
        measured,
        pantograph=wanted.pantograph,
        measured_is_filtered=wanted.is_filtered,
        offset=offset,
    )
    answer.document.update(
        {"case": run.case.name, "version": __version__, "status": run.status, **compared.as_dict()}
    )
    answer.warn(compared.notes)
    answer.show(*_comparison_view(compared))
    if out is not None:
        write_text(out, overlay_csv(compared))
        answer.document["file"] = str(out)
        answer.show(heading("File"), str(out))


def overlay_csv(compared: MeasurementComparison) -> str:
    """Return both forces over the position as CSV."""
    head = ("position [m]", "simulated force [N]", "measured force [N]")
    rows = zip(
        compared.position.tolist(),
        compared.simulated_force.tolist(),
        compared.measured_force.tolist(),
        strict=True,
    )
    return csv_text(head, ((f"{x:.4f}", f"{a:.4f}", f"{b:.4f}") for x, a, b in rows))


def _comparison_view(compared: MeasurementComparison) -> list[Any]:
    rows = [
        (
            _name(row.quantity),
            readable(row.simulated, row.unit),
            readable(row.measured, row.unit),
            _difference(row),
            _tolerance(row),
            _verdict(row),
        )
        for row in compared.rows
    ]
    heads = ("", "simulated", "measured", "difference", "allowed", "verdict")
    return [
        heading("Comparison with a measurement", compared.label),
        facts(
            [
                ("pantograph", compared.pantograph),
                ("part of the line", f"{compared.start:.1f} to {compared.end:.1f} m"),
                ("filter", compared.filter),
                ("tolerances", _outcome(compared)),
            ]
        ),
        heading("Numbers"),
        table(heads, "Lrrrrl", rows),
    ]


def _outcome(compared: MeasurementComparison) -> str:
    """Say how many tolerances are met, and which are not."""
    judged = [row for row in compared.rows if row.within is not None]
    missed = [_name(quantity) for quantity in compared.missed]
    if not judged:
        return "no number has both a tolerance and a value"
    if not missed:
        return f"all {len(judged)} met"
    return f"{len(missed)} of {len(judged)} missed: {', '.join(missed)}"


def _name(quantity: str) -> str:
    names = {"standard_deviation": "σ 0-20 Hz", "contact_height_range": "range of contact height"}
    if quantity.startswith("std_"):
        return f"σ {quantity[4:].replace('_', '-')} Hz"
    return names.get(quantity) or QUANTITIES.get(quantity, quantity)


def _difference(row: MeasurementRow) -> str:
    if not math.isfinite(row.difference):
        return MISSING
    if row.is_relative and row.relative_difference is not None:
        return f"{number(100 * row.relative_difference)} %"
    return readable(row.difference, row.unit)


def _tolerance(row: MeasurementRow) -> str:
    if row.low is None or row.high is None:
        return ""
    if row.is_relative:
        return f"{number(100 * row.low, 0)} to {number(100 * row.high, 0)} %"
    return f"{readable(row.low, row.unit).split()[0]} to {readable(row.high, row.unit)}"


def _verdict(row: MeasurementRow) -> str:
    if row.within is None:
        return ""
    if row.passed is None:  # the tolerance was not compared with the standard's text
        return f"{'met' if row.within else 'missed'}, unverified"
    return "met" if row.within else "missed"


def _refuse_unwritable(path: Path) -> None:
    """Refuse a file name before the work that it is for."""
    if path.is_dir():
        raise InputError(f"--out {path}: is a folder; give the name of a file")
    if not path.parent.is_dir():
        raise InputError(
            f"--out {path}: the folder {path.parent} does not exist; make it or choose another name"
        )
