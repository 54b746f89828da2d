"""``measured``: a recording read, processed and told."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.idle import refuse_idle
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer
from tautwire.cli.views.mapping_view import announce_recording
from tautwire.cli.views.measured_view import evaluation_view
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.reading.air import load_air
from tautwire.inputs.reading.recording import RecordingFile, open_recording
from tautwire.measured.evaluation import Evaluation, Treatment, evaluate
from tautwire.text import csv_text
from tautwire.units import UnitError, parse_quantity
from tautwire.version import __version__

STRETCH = "1 km"
"""Stretches of the statistics that nobody has asked to be others."""


@dataclass(frozen=True)
class RecordingRequest:
    """A recording as the user gives it, quantities as texts.

    Attributes
    ----------
    path, mapping : Path
    speed : str or None
    masses : tuple of str
    is_filtered : bool
    stretch : str
    high, hard : str or None
    air : Path or None
        Table of the aerodynamic correction.
    is_reversed : bool
    """

    path: Path
    mapping: Path | None = None
    speed: str | None = None
    masses: tuple[str, ...] = ()
    is_filtered: bool = False
    stretch: str = STRETCH
    high: str | None = None
    hard: str | None = None
    air: Path | None = None
    is_reversed: bool = False

    def opened(self, speed: float | None = None) -> RecordingFile:
        """Open the file; `speed` holds where none is given."""
        given = quantity("--speed", self.speed, "m/s", 0.5, 200.0)
        return open_recording(self.path, mapping=self.mapping, speed=given or speed)

    def treatment(self) -> Treatment:
        """Return how the recording is processed."""
        idle = {"--reversed": self.is_reversed and self.air is None}
        refuse_idle("--air: it chooses between the forces of that table", idle)
        masses = [quantity("--strip-mass", text, "kg", 0.0, 100.0) for text in self.masses]
        stretch = quantity("--every", self.stretch, "m", 1.0, 1e6)
        changes: dict[str, Any] = {"lowpass": None} if self.is_filtered else {}
        return Treatment(
            masses={number: mass or 0.0 for number, mass in enumerate(masses, 1)},
            air=None if self.air is None else load_air(self.air, is_reversed=self.is_reversed),
            stretch=stretch or 1000.0,
            high_above=quantity("--high", self.high, "N", 0.0, 1e5),
            hard_above=quantity("--hard", self.hard, "m/s^2", 1.0, 1e5),
            **changes,
        )

    def refuse_idle(self, opened: RecordingFile) -> None:
        """Refuse options for channels that the file does not have.

        Raises
        ------
        InputError
            Naming every one of them.
        """
        problems: list[str] = []
        for needs, given in self._idle(opened):
            try:
                refuse_idle(f"{needs}; {opened.path} has none", given)
            except InputError as error:
                problems += error.problems
        if problems:
            raise InputError(problems)

    def _idle(self, opened: RecordingFile) -> Iterator[tuple[str, dict[str, object]]]:
        """Yield what the file lacks, and the options that need it."""
        recording = opened.recording
        if not len(recording.accelerations):
            yield "accelerometers of the head", {"--hard": self.hard}
        if not len(recording.forces):
            yield "a contact force", {
                "--filtered": self.is_filtered, "--strip-mass": self.masses, "--high": self.high,
                "--air": self.air, "--every": self.stretch != STRETCH,
            }  # fmt: skip
        elif recording.distance is None:
            yield "a position or speed", {"--every": self.stretch != STRETCH}
        if has_pace(opened):
            yield (
                "a file without time and speed, or without position and speed",
                {"--speed": self.speed},
            )


def has_pace(opened: RecordingFile) -> bool:
    """Tell whether a file itself says how fast the train ran: by a speed, or a time and a way."""
    there = {one.use.field.name for one in opened.channels if np.isfinite(one.values).any()}
    return "speed" in there or ("time" in there and not there.isdisjoint(("position", "odometer")))


def quantity(option: str, text: str | None, unit: str, low: float, high: float) -> float | None:
    """Read an option; None where it was not given.

    Raises
    ------
    InputError
        When it is no such quantity or out of its range.
    """
    if text is None:
        return None
    try:
        value = parse_quantity(text, unit)
    except UnitError as error:
        raise InputError(f"{option}: {error}") from None
    if not low <= value <= high:
        raise InputError(f"{option}: got {text!r}; must be between {low:g} and {high:g} {unit}")
    return value


def show_recording(answer: Answer, request: RecordingRequest, out: Path | None) -> None:
    """Read, process and show a recording, and write the files that are asked for."""
    treatment = request.treatment()
    opened = request.opened()
    request.refuse_idle(opened)
    found = evaluate(opened.recording, treatment)
    announce_recording(answer, opened)
    answer.document.update({"version": __version__, **found.as_dict()})
    answer.show(*evaluation_view(found))
    if out is not None:
        with prepared_folder(out):
            files = Files(out)
            _write(files, answer, found)
        tell_files(answer, files)


def _write(files: Files, answer: Answer, found: Evaluation) -> None:
    from tautwire.report.pages.measured_page import write_measured_page

    files.write("measured.html", lambda path: write_measured_page(found, path))
    files.write("measured.json", lambda path: write_text(path, to_json(answer.document) + "\n"))
    if found.force is not None:
        files.write("force.csv", lambda path: write_text(path, force_csv(found)))
        files.write("stretches.csv", lambda path: write_text(path, stretches_csv(found)))


def force_csv(found: Evaluation) -> str:
    """Return the processed force over position, or time without one, as CSV; empty are gaps."""
    over, abscissa = found.abscissa
    rows = zip(abscissa.tolist(), found.values.tolist(), strict=True)
    digits = 3 if over.endswith("[m]") else 6
    cells = ((f"{x:.{digits}f}", f"{f:.2f}" if math.isfinite(f) else "") for x, f in rows)
    return csv_text((over, "contact force [N]"), cells)


def stretches_csv(found: Evaluation) -> str:
    """Return the statistics of the stretches as CSV."""
    names = {
        "label": "stretch", "start": "start [m]", "end": "end [m]", "mean": "mean [N]",
        "standard_deviation": "standard deviation [N]", "maximum": "maximum [N]",
        "minimum": "minimum [N]", "measured_share": "measured share",
    }  # fmt: skip
    rows = ([_cell(one[name]) for name in names] for one in found.stretches)
    return csv_text(tuple(names.values()), rows)


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    return value
