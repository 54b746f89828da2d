"""Tables for spreadsheets: CSV with a unit in every heading."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
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
    values = {
        "unstrained length [m]": _texts(shape.dropper_lengths_unstrained, 6),
        "stretched length [m]": _texts(shape.dropper_lengths, 6),
        "force [N]": _texts(shape.dropper_forces, 4),
        "contact wire height [m]": _texts(shape.dropper_heights, 6),
    }
    return dropper_csv(places_of_droppers(shape, case), values)


def dropper_csv(
    places: Mapping[str, Sequence[object]], values: Mapping[str, Sequence[object]]
) -> str:
    """Return a table of droppers as CSV that a case can name.

    Parameters
    ----------
    places
        Columns of :func:`columns_of_places`.
    values
        What is told of every dropper, as texts by heading.
    """
    columns = {**places}
    for name, digits in (("position [m]", 6), ("x [m]", 4), ("chainage [m]", 4)):
        if name in columns:
            columns[name] = _texts(np.array(columns[name]), digits)
    columns |= values
    return csv_text(tuple(columns), zip(*columns.values(), strict=True))


def places_of_droppers(shape: Equilibrium, case: Case) -> dict[str, list[Any]]:
    """Return where droppers hang, by headings from which a table of droppers is read.

    Span and number, mast on the left, tension length and wires where there are several, position
    from the support on the left and along the line, chainage.
    """
    names = shape.wire_names
    return columns_of_places(
        case,
        shape.dropper_span.tolist(),
        shape.dropper_number.tolist(),
        shape.dropper_x.tolist(),
        [(names[upper], names[lower]) for upper, lower in shape.dropper_wires.tolist()],
    )


def columns_of_places(
    case: Case,
    spans: Sequence[int],
    numbers: Sequence[int],
    x: Sequence[float],
    wires: Sequence[tuple[str, str]],
) -> dict[str, list[Any]]:
    """Return the columns that say where droppers hang.

    Parameters
    ----------
    case
        The case whose line it is.
    spans, numbers
        Of every dropper, from 1.
    x
        Along the line [m].
    wires
        Names of the runs above and below every dropper.
    """
    line, masts = case.line, case.line.support_positions()
    columns: dict[str, list[Any]] = {"span": list(spans), "dropper": list(numbers)}
    if line.masts is not None:
        columns["mast"] = [line.masts[span - 1] for span in spans]
    columns |= _wires_of_droppers(case, wires)
    starts = np.array([masts[span - 1] for span in spans])
    columns["position [m]"] = np.round(np.array(x) - starts, 6).tolist()
    columns["x [m]"] = list(x)
    if line.chainage is not None:
        columns["chainage [m]"] = [line.chainage_at(place) for place in x]
    return columns


def _wires_of_droppers(case: Case, wires: Sequence[tuple[str, str]]) -> dict[str, list[str]]:
    """Return tension length and wires of every dropper, as far as they differ."""
    runs = {run.name: run for run in expand(case).runs}
    pairs = [[runs[name] for name in pair] for pair in wires]
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
