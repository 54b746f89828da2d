"""Section IV.B, Figs 12-14: modes whose contact wire is sensitive to DD/2, SD/2, DD/4, SD/4."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.modes import (
    concentration,
    free_wire_frequency,
    mode_spectrum,
    modes_sensitive_to,
)
from tautwire.analyses.shape import find_shape
from tautwire.analyses.wavelengths import line_lengths
from tautwire.model.build import build
from tautwire.reproductions.song2021.claims import Claim, Evidence, least, most
from tautwire.reproductions.song2021.passages import BASE
from tautwire.specs.case import Case
from tautwire.specs.study import Study

Array = NDArray[np.float64]

FRACTIONS = ("DD/2", "SD/2", "DD/4", "SD/4")
TASK = "tautwire.reproductions.song2021.vibration:search"

WIDTH = 0.05
"""Half width of the search around the frequency of a bare wire."""

MESHES = {"DD/2": 9, "SD/2": 9, "DD/4": 15, "SD/4": 15}
QUICK_MESHES = {"DD/2": 9, "SD/2": 9}

VERTICAL = 0.5
"""Least share of the kinetic energy in the vertical motion of the contact wire."""

WAVELENGTH_WITHIN = 1.0
"""Largest deviation of the sensitive wavelength from the wanted one [%]."""


@dataclass(frozen=True, eq=False)
class Found:
    """The best mode for a wavelength.

    Attributes
    ----------
    name : str
        As in ``"DD/2"``.
    wanted : float m
    searched : int
        Number of modes in the band.
    numbers : mapping of str to float
        ``frequency`` [Hz], ``wavelength`` [m], ``participation``, ``concentration``, ``residual``;
        empty when no mode is sensitive to the wavelength.
    x, shape : (n_point,)
        Vertical shape of the contact wire.
    wavenumber, amplitude : (n_line,)
        Its spectrum.
    """

    name: str
    wanted: float
    searched: int
    numbers: Mapping[str, float]
    x: Array
    shape: Array
    wavenumber: Array
    amplitude: Array


def mode_study(meshes: Mapping[str, int], changes: Mapping[str, Any] | None = None) -> Study:
    """Make the study that searches the modes; the title of a case says for which length.

    Parameters
    ----------
    meshes
        NAD by name of the length.
    changes
        Values of the case to replace, by path.
    """
    variants = {
        name: {"title": name, "settings.nodes_between_droppers": mesh}
        for name, mesh in meshes.items()
    }
    return Study.model_validate(
        {
            "schema": 1,
            "name": "song2021-modes",
            "base": BASE,
            "overrides": dict(changes or {}),
            "axes": {"length": {"variants": variants}},
        }
    )


def search(case: Case, _keep_run: bool) -> tuple[dict[str, Any], None]:  # noqa: FBT001
    """Search the modes that are sensitive to the length in the title of a case.

    Parameters
    ----------
    case
    _keep_run
        Without effect: there is no history to keep.
    """
    wanted = line_lengths(case).named(elements=False)[case.title]
    model = build(case)
    found = modes_sensitive_to(model, find_shape(model), wanted, width=WIDTH, count=5)
    values: dict[str, Any] = {
        "name": case.title,
        "wanted": wanted,
        "near": free_wire_frequency(case, wanted),
        "searched": found.counted,
    }
    if len(found.frequencies):
        score = found.participation * concentration(found, wanted)
        best = int(np.argmax(score))
        spectrum = mode_spectrum(found, best)
        shown = spectrum.abscissa <= 1.2
        values |= {
            "numbers": {
                "frequency": float(found.frequencies[best]),
                "wavelength": float(found.wavelengths[best]),
                "participation": float(found.participation[best]),
                "concentration": float(concentration(found, wanted)[best]),
                "residual": float(found.residuals[best]),
            },
            "x": found.x.tolist(),
            "shape": (found.contact_z[best] / np.abs(found.contact_z[best]).max()).tolist(),
            "wavenumber": spectrum.abscissa[shown].tolist(),
            "amplitude": spectrum.value[shown].tolist(),
        }
    return values, None


def read(row: Mapping[str, Any]) -> Found:
    """Read a finished search.

    Parameters
    ----------
    row
        As kept by the study engine.
    """
    values = row["values"]
    return Found(
        values["name"],
        values["wanted"],
        values["searched"],
        values.get("numbers", {}),
        *(np.array(values.get(key, ())) for key in ("x", "shape", "wavenumber", "amplitude")),
    )


def claims(found: Mapping[str, Found]) -> list[Claim]:
    """Judge section IV.B.

    Parameters
    ----------
    found
        Searches by name of the length.
    """
    return [_mode(name, found.get(name)) for name in FRACTIONS]


def _mode(name: str, found: Found | None) -> Claim:
    evidence: list[Evidence] = []
    remark = ""
    if found is not None:
        numbers = found.numbers
        share, wavelength = (numbers.get(k, float("nan")) for k in ("participation", "wavelength"))
        off = abs(100.0 * (wavelength / found.wanted - 1.0))
        evidence = [
            most("", "deviation of its wavelength", off, WAVELENGTH_WITHIN),
            least("", "vertical contact wire in its energy", share, VERTICAL, "1"),
        ]
        remark = (
            f"Best of {found.searched} modes: {numbers['frequency']:.2f} Hz, sensitive wavelength "
            f"{wavelength:.3f} m ({name} is {found.wanted:.3f} m)."
            if numbers
            else f"None of {found.searched} modes within 5 % of the frequency of a bare wire is "
            "sensitive to this wavelength."
        )
    text = f"There are modes whose sensitive wavelength is {name}."
    return Claim(f"mode-{name.replace('/', '-')}", "IV.B, VI.3", text, tuple(evidence), remark)
