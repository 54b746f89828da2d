"""``compare``: runs beside recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any

from tautwire.assessment.coverage import covered
from tautwire.assessment.geometry import GeometryRow, compare_geometry
from tautwire.assessment.limits import load_limits
from tautwire.assessment.measurement import MeasurementComparison, compare_with_measurement
from tautwire.cli.commands.measuring.measured import RecordingRequest, quantity
from tautwire.cli.commands.results import load_runs
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer
from tautwire.cli.views.mapping_view import announce_recording
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.attached import load_project
from tautwire.inputs.reading.recording import RecordingFile
from tautwire.measured.files.formats import is_computed
from tautwire.report.parts.recordings.comparison import (
    HEADS,
    number_row,
    outcome_of,
    percentile_rows,
    verdict_of,
)
from tautwire.report.parts.words import readable
from tautwire.results.run import Run
from tautwire.specs.project import Project
from tautwire.text import csv_text
from tautwire.version import __version__

FARTHEST = 1e7
"""Largest offset and search [m], that of the chainage of a line."""


@dataclass(frozen=True)
class ComparisonRequest:
    """What is to be compared, quantities as texts.

    Attributes
    ----------
    files : tuple of Path
        Runs and recordings.
    reading : RecordingRequest
        How the recordings are read.
    pantographs : tuple of str
    offset : str
    search : str or None
    limits : Path or None
    project : Path or None
        File with the project block.
    """

    files: tuple[Path, ...]
    reading: RecordingRequest
    pantographs: tuple[str, ...] = ()
    offset: str = "0 m"
    search: str | None = None
    limits: Path | None = None
    project: Path | None = None

    def pairs(self) -> list[tuple[Path, Path]]:
        """Return runs and recordings in pairs.

        Raises
        ------
        InputError
            When they make no pairs.
        """
        first, *others = self.files
        runs = [first, *(path for path in others if is_computed(path))]
        recordings = [path for path in others if path not in runs]
        if not recordings:
            raise InputError(
                f"{first}: give a recording too, as in: tautwire compare run.nc recording.csv"
            )
        if len(runs) != len(recordings) and 1 not in (len(runs), len(recordings)):
            raise InputError(
                f"{len(runs)} runs and {len(recordings)} recordings make no pairs; give one of "
                "either, or as many of both"
            )
        count = max(len(runs), len(recordings))
        return [(runs[n % len(runs)], recordings[n % len(recordings)]) for n in range(count)]

    def pantograph_of(self, number: int, count: int) -> str | None:
        """Return the pantograph of a pair; None for the leading one."""
        if len(self.pantographs) not in (0, 1, count):
            raise InputError(
                f"--pantograph: got {len(self.pantographs)} names for {count} comparisons; give "
                "one, or one for each"
            )
        return self.pantographs[number % len(self.pantographs)] if self.pantographs else None


def compare_runs(answer: Answer, request: ComparisonRequest, out: Path | None) -> None:
    """Compare stored runs with recordings, show the tables and write the files asked for."""
    offset = quantity("--offset", request.offset, "m", -FARTHEST, FARTHEST)
    search = quantity("--search", request.search, "m", 0.0, FARTHEST)
    treatment = request.reading.treatment()
    limits = None if request.limits is None else load_limits(request.limits)
    pairs = request.pairs()
    block = None if request.project is None else load_project(request.project)
    runs = dict(zip((path for path, _ in pairs), load_runs([a for a, _ in pairs]), strict=True))
    opened: dict[Path, RecordingFile] = {}
    found: list[MeasurementComparison] = []
    told: list[dict[str, Any]] = []
    compared_runs: list[Run] = []
    for number, (run_file, path) in enumerate(pairs):
        run = runs[run_file]
        if path not in opened:
            reading = replace(request.reading, path=path)
            opened[path] = reading.opened(run.case.scenario.speed)
            announce_recording(answer, opened[path])
        recording = opened[path].recording
        geometry = compare_geometry(run, recording, offset=offset or 0.0)
        about = {"run": str(run_file), "case": run.case.name, "status": run.status}
        told.append({**about, "geometry": [row.as_dict() for row in geometry]})
        if not len(recording.forces):
            told[-1] |= {"measurement": recording.label, "notes": list(recording.notes)}
            answer.warn(recording.notes)
            answer.show(
                heading("Comparison with a measurement", f"{run_file} and {recording.label}"),
                *_geometry_view(geometry),
            )
            continue
        compared = compare_with_measurement(
            run,
            recording,
            pantograph=request.pantograph_of(number, len(pairs)),
            treatment=treatment,
            offset=offset or 0.0,
            search=search,
            limits=limits,
        )
        found.append(compared)
        compared_runs.append(run)
        told[-1] |= compared.as_dict()
        answer.warn([*compared.notes, *_faults(compared)])
        answer.show(*_comparison_view(run_file, compared), *_geometry_view(geometry))
    answer.document.update({"version": __version__, "comparisons": told})
    if found:
        answer.document["covers"] = covered([compared.coverage for compared in found])
    if out is not None:
        _write_files(answer, out, compared_runs, found, block)


def _faults(compared: MeasurementComparison) -> list[str]:
    return [
        f"{fault['kind']}, {fault['channel']}: {fault['text']}"
        for fault in compared.evaluation.faults
    ]


def _geometry_view(rows: Sequence[GeometryRow]) -> list[Any]:
    """Return the table of heights and staggers; nothing where none was measured."""
    if not rows:
        return []
    cells = [
        (row.quantity, readable(row.mean, "m"), readable(row.standard_deviation, "m"),
         readable(row.largest, "m"), f"{row.place:.1f} m")
        for row in rows
    ]  # fmt: skip
    return [
        heading("Contact wire at rest, simulated minus measured"),
        table(("", "mean", "deviation", "largest", "at"), "lrrrr", cells),
    ]


def _write_files(
    answer: Answer,
    out: Path,
    runs: Sequence[Run],
    found: Sequence[MeasurementComparison],
    project: Project | None,
) -> None:
    from tautwire.report.pages.comparison_page import compose_comparison

    with prepared_folder(out):
        files = Files(out)
        if found:
            page = compose_comparison(runs, found, project)
            files.write("comparison.html", page.write)
        text = to_json(answer.document) + "\n"
        files.write("comparison.json", lambda path: write_text(path, text))
        for number, compared in enumerate(found, 1):
            content = overlay_csv(compared)
            name = "forces.csv" if number == 1 else f"forces-{number}.csv"
            files.write(name, lambda path, content=content: write_text(path, content))
    tell_files(answer, files)


def overlay_csv(compared: MeasurementComparison) -> str:
    """Return both forces over the position as CSV; empty cells were not measured."""
    head = ("position [m]", "simulated force [N]", "measured force [N]")
    rows = zip(
        compared.position.tolist(),
        compared.simulated_force.tolist(),
        compared.measured_force.tolist(),
        strict=True,
    )
    return csv_text(
        head, ((f"{x:.4f}", f"{a:.4f}", f"{b:.4f}" if isfinite(b) else "") for x, a, b in rows)
    )


def _comparison_view(run_file: Path, compared: MeasurementComparison) -> list[Any]:
    rows = [(*number_row(row), verdict_of(row)) for row in compared.rows]
    return [
        heading("Comparison with a measurement", f"{run_file} and {compared.label}"),
        facts(
            [
                ("pantograph", compared.pantograph),
                ("part of the line", f"{compared.start:.1f} to {compared.end:.1f} m"),
                ("position", compared.placement.text),
                ("filter", compared.filter),
                ("tolerances", outcome_of(compared)),
            ]
        ),
        heading("Numbers"),
        table(HEADS, "lrrrLL", rows),
        heading("Force below which a share of the way lies"),
        table(("", "simulated", "measured", "difference"), "Lrrr", percentile_rows(compared)),
    ]
