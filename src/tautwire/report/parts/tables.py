"""Tables for spreadsheets: CSV with a unit in every heading."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.files import write_text
from tautwire.line.expand import expand
from tautwire.report.parts.views import WIDE_CUTOFF, filtered_or_none, headline_filter
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.results.statistics import LOSS_BAND
from tautwire.specs.case import Case
from tautwire.text import csv_text


def dropper_table_csv(equilibrium: Equilibrium, case: Case) -> str:
    """Return the dropper table of a static line as CSV, one row per dropper.

    Parameters
    ----------
    equilibrium : Equilibrium
    case : Case
        The case whose line it is.

    Returns
    -------
    str
        Columns: span and dropper (from 1), the mast on the left and the chainage where the case has
        them, tension length and wires where there are several, position from the support on the
        left and x along the line, unstrained and stretched length, force, height of the wire below;
        the table of droppers of a case may be such a file.
    """
    shape = equilibrium
    columns: dict[str, Sequence[object]] = {**places_of_droppers(shape, case)}
    for name, digits in (("position [m]", 6), ("x [m]", 4), ("chainage [m]", 4)):
        if name in columns:
            columns[name] = _texts(np.array(columns[name]), digits)
    columns["unstrained length [m]"] = _texts(shape.dropper_lengths_unstrained, 6)
    columns["stretched length [m]"] = _texts(shape.dropper_lengths, 6)
    columns["force [N]"] = _texts(shape.dropper_forces, 4)
    columns["contact wire height [m]"] = _texts(shape.dropper_heights, 6)
    return csv_text(tuple(columns), zip(*columns.values(), strict=True))


def places_of_droppers(shape: Equilibrium, case: Case) -> dict[str, list[Any]]:
    """Return where droppers hang, by headings from which a table of droppers is read.

    Span and number, mast on the left, tension length and wires where there are several, position
    from the support on the left and along the line, chainage.
    """
    line, spans = case.line, shape.dropper_span.tolist()
    columns: dict[str, list[Any]] = {"span": spans, "dropper": shape.dropper_number.tolist()}
    if line.masts is not None:
        columns["mast"] = [line.masts[span - 1] for span in spans]
    columns |= _wires_of_droppers(shape, case)
    starts = shape.mast_x[shape.dropper_span - 1]
    columns["position [m]"] = np.round(shape.dropper_x - starts, 6).tolist()
    columns["x [m]"] = shape.dropper_x.tolist()
    if line.chainage is not None:
        columns["chainage [m]"] = [line.chainage_at(x) for x in shape.dropper_x.tolist()]
    return columns


def _wires_of_droppers(shape: Equilibrium, case: Case) -> dict[str, list[str]]:
    """Return tension length and wires of every dropper, as far as they differ."""
    runs = {run.name: run for run in expand(case).runs}
    pairs = [[runs[shape.wire_names[wire]] for wire in pair] for pair in shape.dropper_wires]
    columns = {
        "tension length": [lower.tension_length for _, lower in pairs],
        "from": [upper.wire_name for upper, _ in pairs],
        "to": [lower.wire_name for _, lower in pairs],
    }
    usual = {"from": {"messenger"}, "to": {"contact"}, "tension length": {""}}
    return {name: told for name, told in columns.items() if set(told) - usual[name]}


def force_history_csv(run: Run, pantograph: str | None = None) -> str:
    """Return the contact force of one pantograph over time and position as CSV.

    Parameters
    ----------
    run : Run
    pantograph : str, optional
        Name; by default the leading one.

    Returns
    -------
    str
        Columns: time, position, unfiltered force, and the force low-passed at the headline
        cut-off and at 200 Hz, where the record is sampled fast enough; the heading names filter
        and cut-off. With several contact wires, the unfiltered force on each that was touched. A
        last column tells what mesh and step carry where that is less than these bands.

    Raises
    ------
    InputError
        When no pantograph has that name.
    """
    from tautwire.analyses.force.contact_loss import carried_band
    from tautwire.analyses.force.statistics import uniform_force, uniform_shares

    name = pantograph or run.pantographs[0].name
    force = uniform_force(run, name)
    head = ["time [s]", "position [m]", "force [N]"]
    columns = [
        _texts(force.time, 6),
        _texts(force.position, 5),
        _texts(force.force, 4),
    ]
    if force.time.size > 1:
        lowpass = headline_filter(run)
        for cutoff in (lowpass.cutoff, WIDE_CUTOFF):
            values = filtered_or_none(lowpass.with_cutoff(cutoff), force.force, force.time_step)
            if values is not None:
                head.append(f"force, {lowpass.kind} low-pass {cutoff:g} Hz [N]")
                columns.append(_texts(values, 4))
    for wire, share in uniform_shares(run, name).items():
        head.append(f"force on {wire} [N]")
        columns.append(_texts(share, 4))
    carried = carried_band(run)
    if carried * (1.0 + 1e-6) < LOSS_BAND:
        head.append("mesh and step carry [Hz]")
        columns.append([f"{carried:.0f}"] * force.time.size)
    return csv_text(head, zip(*columns, strict=True))


def write_dropper_table(equilibrium: Equilibrium, case: Case, path: str | os.PathLike[str]) -> Path:
    """Write :func:`dropper_table_csv` to a file, completely or not at all."""
    return write_text(path, dropper_table_csv(equilibrium, case))


def write_force_history(
    run: Run, path: str | os.PathLike[str], pantograph: str | None = None
) -> Path:
    """Write :func:`force_history_csv` to a file, completely or not at all."""
    return write_text(path, force_history_csv(run, pantograph))


def _texts(values: np.ndarray, digits: int) -> list[str]:
    """Return numbers with a fixed count of decimals; not-a-number becomes an empty cell."""
    return [f"{value:.{digits}f}" if math.isfinite(value) else "" for value in values.tolist()]
