"""``modes``: modes near a frequency, or those sensitive to a wavelength."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.vibration.modes import (
    COUNT,
    NEAR,
    free_wire_frequency,
    modes,
    modes_sensitive_to,
)
from tautwire.analyses.vibration.wavelengths import NAMED_WITHIN, LineLengths, line_lengths
from tautwire.cli.about import program
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.json_text import to_json
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.attached import with_project
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.report.pages.mode_page import write_modes_report
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.modes import Modes
from tautwire.specs.case import Case
from tautwire.units import UnitError, parse_quantity
from tautwire.version import __version__

FEW = 5
"""Modes shown for a wavelength."""


@dataclass(frozen=True)
class ModesRequest:
    """What the user asked for.

    Attributes
    ----------
    case : str
    overrides : sequence of str
    near : float or None
        [Hz]; None for the first modes.
    count : int or None
    wavelength : str or None
        A length, or the name of one, such as ``DD/2``.
    out : Path or None
    project : Path or None
        File with the project block.
    """

    case: str
    overrides: Sequence[str]
    near: float | None
    count: int | None
    wavelength: str | None
    out: Path | None
    project: Path | None = None


def find_modes(answer: Answer, request: ModesRequest) -> None:
    """Find modes of a case, show them, and write their files."""
    case = with_project(load_case(request.case, request.overrides), request.project)
    lengths = line_lengths(case)
    wavelength = _wavelength(request.wavelength, lengths)
    answer.say(program(case.settings.backend))
    with nullcontext() if request.out is None else prepared_folder(request.out) as folder:
        with Interrupts().handled():
            shape, found = _computed(answer, case, request, wavelength)
        answer.document.update(_document(case, lengths, found, wavelength))
        is_first = wavelength is None and request.near is None
        answer.show(*_view(case, shape, lengths, found, wavelength, is_first=is_first))
        if not found.is_complete and wavelength is None:
            answer.warn([_incomplete(found)])
        if folder is not None:
            _write(answer, folder, case, shape, found)


def _computed(
    answer: Answer, case: Case, request: ModesRequest, wavelength: float | None
) -> tuple[Equilibrium, Modes]:
    model = build(case)
    shape = find_shape(model)
    if wavelength is None:
        near = NEAR if request.near is None else request.near
        count = COUNT if request.count is None else request.count
        return shape, modes(model, shape, near=near, count=count)
    answer.say("searching all modes of a band; this can take a minute")
    count = FEW if request.count is None else request.count
    return shape, modes_sensitive_to(model, shape, wavelength, near=request.near, count=count)


def _wavelength(text: str | None, lengths: LineLengths) -> float | None:
    """Read a wavelength: a length, or the name of one of the line's own."""
    if text is None:
        return None
    named = lengths.named(elements=False)
    by_name = {name.lower(): value for name, value in named.items()}
    if text.strip().lower() in by_name:
        return by_name[text.strip().lower()]
    try:
        return parse_quantity(_number(text), "m")
    except UnitError as error:
        raise InputError(
            f"--wavelength: {error}; or the name of a length of the line: {', '.join(named)}"
        ) from None


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _incomplete(found: Modes) -> str:
    return (
        f"{len(found.frequencies)} modes were found, but {found.counted} lie between the lowest "
        "and the highest of them; try a slightly different --near or a larger --count"
    )


def _document(
    case: Case, lengths: LineLengths, found: Modes, wavelength: float | None
) -> dict[str, Any]:
    return {
        "case": case.name,
        "case_hash": case.hash(),
        "version": __version__,
        "lengths_m": lengths.named(),
        "wavelength_m": wavelength,
        "searched": found.counted if wavelength is not None else None,
        **found.as_dict(),
        "ranking": (found.ranked() + 1).tolist(),
    }


def _view(
    case: Case,
    shape: Equilibrium,
    lengths: LineLengths,
    found: Modes,
    wavelength: float | None,
    *,
    is_first: bool,
) -> list[Any]:
    """Return what the terminal shows; the first modes by rising frequency, others by their rank."""
    if wavelength is None and is_first:
        detail = f"the first {len(found.frequencies)} modes"
    elif wavelength is None:
        detail = f"{len(found.frequencies)} modes, most vertical contact wire first"
    else:
        expected = free_wire_frequency(build(case), shape, wavelength)
        detail = (
            f"sensitive to {wavelength:.4g} m, of {found.counted} modes searched "
            f"(a bare wire has it at {expected:.1f} Hz)"
        )
    parts: list[Any] = [heading(case.title or case.name, detail)]
    if len(found.frequencies):
        heads = ("frequency\n[Hz]", "wavelength\n[m]", "", "contact\nvertical",
                 "contact\nlateral", "messenger\nvertical", "messenger\nlateral")  # fmt: skip
        order = range(len(found.frequencies)) if is_first else found.ranked().tolist()
        rows = [_row(found, i, lengths) for i in order]
        parts.append(table(heads, "rrlrrrr", rows))
    else:
        parts.append("no mode of the searched band is sensitive to this wavelength")
    searched = " (all searched)" if wavelength is not None else ""
    parts.append(
        facts(
            [
                ("orthogonality", f"{found.orthogonality:.1e}"),
                ("largest residual", f"{found.residuals.max(initial=0.0):.1e}"),
                ("counted by inertia", f"{found.counted}{searched}"),
            ]
        )
    )
    return parts


def _row(found: Modes, at: int, lengths: LineLengths) -> tuple[str, ...]:
    x, y, z, *messenger = (f"{100 * share:.0f} %" for share in found.shares[at])
    del x
    wavelength = float(found.wavelengths[at])
    return (
        f"{found.frequencies[at]:.4f}",
        f"{wavelength:.3f}",
        _name(wavelength, lengths),
        z,
        y,
        messenger[2],
        messenger[1],
    )


def _name(wavelength: float, lengths: LineLengths) -> str:
    """Name the line's own length that a wavelength is within 2 % of."""
    for name, length in lengths.named(elements=False).items():
        if np.isfinite(wavelength) and abs(wavelength / length - 1.0) <= NAMED_WITHIN:
            return name
    return ""


def _write(answer: Answer, folder: Path, case: Case, shape: Equilibrium, found: Modes) -> None:
    files = Files(folder)
    text = to_json(answer.document) + "\n"
    files.write("modes.json", lambda path: write_text(path, text))
    files.write("modes.csv", lambda path: write_text(path, found.to_csv()))
    files.write("mode-shapes.csv", lambda path: write_text(path, found.shapes_csv()))
    files.write("modes.html", lambda path: write_modes_report(case, shape, found, path))
    tell_files(answer, files)
