"""Tables for spreadsheets: CSV with a unit in every heading."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from tautwire.files import write_text
from tautwire.report.parts.views import WIDE_CUTOFF, filtered_or_none, headline_filter
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.results.statistics import LOSS_BAND
from tautwire.text import csv_text


def dropper_table_csv(equilibrium: Equilibrium) -> str:
    """Return the dropper table of a static line as CSV, one row per dropper.

    Parameters
    ----------
    equilibrium : Equilibrium

    Returns
    -------
    str
        Columns: span and dropper (from 1), position from the support on the left and x along the
        line, unstrained and stretched length, force, height of the contact wire; the table of
        droppers of a case may be such a file.
    """
    head = (
        "span",
        "dropper",
        "position [m]",
        "x [m]",
        "unstrained length [m]",
        "stretched length [m]",
        "force [N]",
        "contact wire height [m]",
    )
    left = dict(zip(equilibrium.support_number.tolist(), equilibrium.support_x, strict=True))
    starts = np.array([left[span] for span in equilibrium.dropper_span.tolist()])
    rows = zip(
        equilibrium.dropper_span.tolist(),
        equilibrium.dropper_number.tolist(),
        *(
            _texts(values, digits)
            for values, digits in (
                (equilibrium.dropper_x - starts, 4),
                (equilibrium.dropper_x, 4),
                (equilibrium.dropper_lengths_unstrained, 6),
                (equilibrium.dropper_lengths, 6),
                (equilibrium.dropper_forces, 4),
                (equilibrium.dropper_heights, 6),
            )
        ),
        strict=True,
    )
    return csv_text(head, rows)


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


def write_dropper_table(equilibrium: Equilibrium, path: str | os.PathLike[str]) -> Path:
    """Write :func:`dropper_table_csv` to a file, completely or not at all."""
    return write_text(path, dropper_table_csv(equilibrium))


def write_force_history(
    run: Run, path: str | os.PathLike[str], pantograph: str | None = None
) -> Path:
    """Write :func:`force_history_csv` to a file, completely or not at all."""
    return write_text(path, force_history_csv(run, pantograph))


def _texts(values: np.ndarray, digits: int) -> list[str]:
    """Return numbers with a fixed count of decimals; not-a-number becomes an empty cell."""
    return [f"{value:.{digits}f}" if np.isfinite(value) else "" for value in values.tolist()]
