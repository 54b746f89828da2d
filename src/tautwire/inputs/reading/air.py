"""Tables of the aerodynamic force on what is above the sensors of a pantograph."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from tautwire.errors import InputError
from tautwire.inputs.reading.tables import Cells, read_columns
from tautwire.measured.processing import AerodynamicCorrection
from tautwire.tables.columns import RECORDING, fields_of, named_field

_FIELDS = (named_field("speed", "m/s"), named_field("force", "N"), named_field("reversed", "N"))


def load_air(path: Path, *, is_reversed: bool = False) -> AerodynamicCorrection:
    """Load the aerodynamic correction: force over speed, by direction of running.

    Parameters
    ----------
    path
        CSV or workbook with columns ``speed``, ``force``, and ``reversed`` for the other direction.
    is_reversed
        Whether the pantograph runs the other way round.

    Raises
    ------
    InputError
        When a cell cannot be used, speeds do not increase or are those of no train, or the
        direction is missing.
    """
    table = read_columns(path, _FIELDS, ("reversed",))
    columns = table.values
    speed = [float(value) for value in columns["speed"]]
    steps = [after - before for before, after in pairwise(speed)]
    problems = []
    if not steps or min(steps) <= 0.0:
        problems.append(f"{path}: the speeds must increase, at least two of them")
    problems += _impossible(speed, table.cells["speed"])
    if is_reversed and "reversed" not in columns:
        problems.append(
            f"{path}: has no force for the other direction; add a column 'reversed [N]', or leave "
            "--reversed out"
        )
    if problems:
        raise InputError(problems)
    name = "reversed" if is_reversed else "force"
    force = tuple(float(value) for value in columns[name])
    return AerodynamicCorrection(tuple(speed), force, "reversed" if is_reversed else "forward")


def _impossible(speed: Sequence[float], cells: Cells) -> list[str]:
    """Name the first speed [m/s] at which no train runs; without a unit a column is in SI."""
    fastest = _fastest()
    for index, value in enumerate(speed):
        if not 0.0 <= value <= fastest:
            return [
                f"{cells(index)}: got {value:g} m/s; trains run at 0 to {fastest:g} m/s "
                f"({3.6 * fastest:g} km/h); say the unit, as in 'speed [km/h]'"
            ]
    return []


def _fastest() -> float:
    """Return the speed [m/s] up to which the channel of a recording is plausible."""
    (plausible,) = (one.plausible for one in fields_of(RECORDING) if one.name == "speed")
    assert plausible is not None
    return plausible[2]
