"""Section IV.B, Figs 12-14: modes whose contact wire is sensitive to DD/2, SD/2, DD/4, SD/4."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.vibration.modes import (
    concentration,
    mode_spectrum,
    modes_sensitive_to,
)
from tautwire.analyses.vibration.wavelengths import line_lengths
from tautwire.model.build import Model, build
from tautwire.reproductions.song2021.claims import (
    ALWAYS,
    Claim,
    Condition,
    Evidence,
    least,
    most,
)
from tautwire.reproductions.song2021.passages import BASE, NUMERICS
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.specs.study import Study

Array = NDArray[np.float64]

FRACTIONS = ("DD/2", "SD/2", "DD/4", "SD/4")
TASK = "tautwire.reproductions.song2021.sections.vibration:search"

WIDTH = 0.05
"""Half width of the search around the frequency of a bare wire."""

MESHES = {"DD/2": 9, "SD/2": 9, "DD/4": 15, "SD/4": 15}
QUICK_MESHES = {"DD/2": 9, "SD/2": 9}

MOST_SENSITIVE = 1000
"""Most modes that are counted as sensitive to one wavelength."""

CONTROLS = (0.8, 0.9, 1.1, 1.2)
"""Control wavelengths over the wanted one."""

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
        As in ``"DD/2"``, or ``"0.9 DD/2"`` for a control.
    wanted : float m
    searched : int
        Number of modes in the band.
    sensitive : int
        Number of them that are sensitive to the wavelength.
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
    sensitive: int
    numbers: Mapping[str, float]
    x: Array
    shape: Array
    wavenumber: Array
    amplitude: Array

    @property
    def score(self) -> float:
        """Vertical participation times concentration of the best mode; 0 without one."""
        return self.numbers.get("participation", 0.0) * self.numbers.get("concentration", 0.0)


def control(name: str, factor: float) -> str:
    """Name a control wavelength."""
    return f"{factor:g} {name}"


def mode_study(meshes: Mapping[str, int], changes: Mapping[str, Any] | None = None) -> Study:
    """Make the study that searches the modes: one case for every mesh.

    Parameters
    ----------
    meshes
        NAD by name of the length.
    changes
        Values of the case to replace, by path.
    """
    variants = {
        f"NAD {mesh}": {"settings.nodes_between_droppers": mesh}
        for mesh in sorted(set(meshes.values()))
    }
    return Study.model_validate(
        {
            "schema": 1,
            "name": "song2021-modes",
            "base": BASE,
            "overrides": {**NUMERICS, **(changes or {})},
            "axes": {"mesh": {"variants": variants}},
        }
    )


def search(case: Case, _keep_run: bool) -> tuple[dict[str, Any], None]:  # noqa: FBT001
    """Search the modes that are sensitive to the lengths which the mesh of a case is for.

    Every length is searched beside control lengths that mean nothing to the line.

    Parameters
    ----------
    case
    _keep_run
        Without effect: there is no history to keep.
    """
    lengths = line_lengths(case).named(elements=False)
    model = build(case)
    shape = find_shape(model)
    found = {}
    for name, mesh in MESHES.items():
        if mesh == case.settings.nodes_between_droppers:
            wanted = {name: lengths[name]}
            wanted |= {control(name, factor): factor * lengths[name] for factor in CONTROLS}
            found |= {key: _best(model, shape, length) for key, length in wanted.items()}
    return {"found": found}, None


def _best(model: Model, shape: Equilibrium, wanted: float) -> dict[str, Any]:
    """Return the best mode for a wavelength [m] as plain data."""
    found = modes_sensitive_to(model, shape, wanted, width=WIDTH, count=MOST_SENSITIVE)
    values: dict[str, Any] = {
        "wanted": wanted,
        "searched": found.counted,
        "sensitive": len(found.frequencies),
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
    return values


def gather(rows: Mapping[str, Mapping[str, Any]]) -> dict[str, Found]:
    """Read the finished searches by name of the length, controls included.

    Parameters
    ----------
    rows
        As kept by the study engine.
    """
    return {
        name: Found(
            name,
            values["wanted"],
            values["searched"],
            values["sensitive"],
            values.get("numbers", {}),
            *(np.array(values.get(key, ())) for key in ("x", "shape", "wavenumber", "amplitude")),
        )
        for row in rows.values()
        for name, values in row["values"]["found"].items()
    }


def controls(found: Mapping[str, Found], name: str) -> list[Found]:
    """Return the searches at control wavelengths of a length."""
    names = (control(name, factor) for factor in CONTROLS)
    return [found[own] for own in names if own in found]


def claims(found: Mapping[str, Found]) -> list[Claim]:
    """Judge section IV.B.

    Parameters
    ----------
    found
        Searches by name of the length.
    """
    return [*(_mode(name, found) for name in FRACTIONS), _special(found)]


def _mode(name: str, every: Mapping[str, Found]) -> Claim:
    evidence: list[Evidence] = []
    remark = ""
    found = every.get(name)
    if found is not None:
        numbers = found.numbers
        share, wavelength = (numbers.get(k, float("nan")) for k in ("participation", "wavelength"))
        off = abs(100.0 * (wavelength / found.wanted - 1.0))
        evidence = [
            most(ALWAYS, "deviation of its wavelength", off, WAVELENGTH_WITHIN),
            least(ALWAYS, "vertical contact wire in its energy", share, VERTICAL, "1"),
        ]
        remark = f"{_found_text(name, found)} {_control_text(every, name)}"
    text = f"There are modes whose sensitive wavelength is {name}."
    return Claim(f"mode-{name.replace('/', '-')}", "IV.B, VI.3", text, tuple(evidence), remark)


def _found_text(name: str, found: Found) -> str:
    numbers = found.numbers
    if not numbers:
        return (
            f"None of {found.searched} modes within 5 % of the frequency of a bare wire is "
            "sensitive to this wavelength."
        )
    return (
        f"Best of {found.searched} modes: {numbers['frequency']:.2f} Hz, sensitive wavelength "
        f"{numbers['wavelength']:.3f} m ({name} is {found.wanted:.3f} m)."
    )


def _control_text(every: Mapping[str, Found], name: str) -> str:
    others = controls(every, name)
    kept = [other.wanted for other in others if _is_found(other)]
    if not others:
        return ""
    return (
        f"By the same limits there are such modes for {len(kept)} of {len(others)} control "
        f"wavelengths ({CONTROLS[0]:g} to {CONTROLS[-1]:g} times {name}), so that finding one says "
        f"{'little' if kept else 'something'} about the line's own length."
    )


def _is_found(found: Found) -> bool:
    numbers = found.numbers
    if not numbers:
        return False
    off = 100.0 * abs(numbers["wavelength"] / found.wanted - 1.0)
    return off <= WAVELENGTH_WITHIN and numbers["participation"] >= VERTICAL


def _special(every: Mapping[str, Found]) -> Claim:
    """Ask whether the line's own lengths find better modes than wavelengths that mean nothing."""
    evidence: list[Evidence] = []
    for name in FRACTIONS:
        others = controls(every, name)
        if name not in every or not others:
            continue
        own = every[name]
        best, where = max(other.score for other in others), Condition(name)
        evidence += [
            Evidence(where, "participation times concentration of the best mode", own.score, "1",
                     low=best),
            Evidence(where, "lowest of the controls", min(o.score for o in others), "1"),
            Evidence(where, "share of the modes searched that are sensitive to it",
                     100.0 * own.sensitive / max(own.searched, 1), "%"),
            Evidence(where, "the same, mean of the controls",
                     100.0 * float(np.mean([o.sensitive / max(o.searched, 1) for o in others])),
                     "%"),
        ]  # fmt: skip
    text = (
        "Modes amplify the excitation at DD/2, SD/2, DD/4 and SD/4 (limit: their best mode is more "
        f"sensitive than those of {len(CONTROLS)} control wavelengths; by chance one length in "
        f"{len(CONTROLS) + 1} passes)."
    )
    return Claim("mode-special", "IV.B", text, tuple(evidence))
