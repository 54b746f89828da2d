"""The passages that the figures and tables of the paper need, as data.

Every passage is the library case ``ac-simple`` with a few values replaced. They are run by the
study engine: in parallel, each on disk as soon as it is finished, resumable.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tautwire.specs.study import Study

BASE = "ac-simple"

NUMERICS: Mapping[str, Any] = {
    "settings.nodes_between_droppers": 9,
    "settings.time_step": "1 ms",
    "settings.step_control": {"corrects_waves": False},
}
"""Mesh, time step and plain Newmark scheme as the paper has them, where a study names no others:
what the paper says of spectra, losses and steps it says of histories of this scheme."""

MESHES = (9, 12, 15, 18)
"""Nodes between adjacent droppers (NAD) of section III.A."""

STIFFNESSES = (50, 100, 200, 300, 400, 500)
"""Contact stiffnesses of section III.B [kN/m]."""

LINES: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "hinged": ("arms hinged at 10°", {}),
    "held": (
        "arms hinged at 10°, messenger wire held along the track",
        {"supports.messenger_longitudinal": "fixed"},
    ),
    "plane": ("plane arms", {"supports.closure": "height", "supports.arm.motion": "vertical"}),
}
"""Readings of the line: name, words, values that differ from the library case. The first is the
library case, in which nothing is calibrated."""


@dataclass(frozen=True, order=True)
class Reading:
    """What the paper does not state: the line, and the contact stiffness.

    Attributes
    ----------
    line : str
        Key of :data:`LINES`.
    stiffness : int
        Contact stiffness [kN/m].
    """

    line: str
    stiffness: int

    @property
    def name(self) -> str:
        """Short name, part of the names of passages."""
        return f"{self.line}-k{self.stiffness}"

    def __str__(self) -> str:
        """Return the reading in words."""
        return f"{LINES[self.line][0]}, {self.stiffness} kN/m"

    def values(self) -> dict[str, Any]:
        """Return the values that differ from the library case."""
        return {
            **LINES[self.line][1],
            "settings.contact_stiffness": f"{self.stiffness} kN/m",
        }


UNCALIBRATED = Reading("hinged", 50)
"""The library case: no number of it was selected to meet a result."""

READINGS = (
    UNCALIBRATED,
    Reading("hinged", 200),
    Reading("hinged", 500),
    Reading("held", 50),
    Reading("plane", 50),
    Reading("plane", 200),
    Reading("plane", 500),
)
"""Readings under which every claim is judged, the uncalibrated one first."""


def series(line: str) -> tuple[Reading, ...]:
    """Return the readings of a line over the contact stiffness."""
    return tuple(Reading(line, stiffness) for stiffness in STIFFNESSES)


SPEEDS = (200, 225, 250, 275, 320)
"""Speeds of Fig. 15 [km/h]."""

TOP_SPEED = SPEEDS[-1]

OTHER_MEAN = 169.0
"""Mean force at all speeds, the other reading of what the paper leaves open [N]."""

UPLIFT_SHARE = 1.0985
"""Uplift force over mean force: first guess, so that few passages are needed."""

CONVENTIONS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "height": ("contact wire held at its height, arms at 10.8°", {"supports.closure": "height"}),
    "angle-5": ("arms at 5°", {"supports.arm.angle": "5 deg"}),
    "angle-15": ("arms at 15°", {"supports.arm.angle": "15 deg"}),
    "lift": ("arms carry nothing (closure lift, 0 N)", {"supports.closure": "lift"}),
    "stagger": ("messenger wire not staggered", {"supports.messenger_stagger": 0.0}),
    "weighted": ("wire ends with constant tension", {"line.ends": "weighted"}),
    "damping-0": ("no stiffness-proportional damping", {"line.damping.stiffness": 0.0}),
    "damping-3": ("stiffness-proportional damping 3e-4 s", {"line.damping.stiffness": 3e-4}),
    "dropper": ("droppers of 100 kN/m", {"droppers.stiffness": "100 kN/m"}),
    "half-step": ("time step 0.5 ms", {"settings.time_step": "0.5 ms"}),
    "fine-step": ("time step 0.2 ms", {"settings.time_step": "0.2 ms"}),
}
"""Other readings of what the paper leaves open, each alone beside the uncalibrated one: name,
words, values that differ."""

HEIGHTS, SURFACE, ROUGH = "heights", "surface", "rough"
"""Irregularities of section V."""


@dataclass(frozen=True)
class Scope:
    """How much is computed.

    Attributes
    ----------
    name : str
        ``"full"`` or ``"quick"``.
    mesh : int
        NAD of the studies of stiffness and speed.
    readings : tuple of Reading
        Readings of the studies of mesh and speed, the uncalibrated one first.
    lines : tuple of str
        Lines of the study of contact stiffness.
    conventions : tuple of str
        Names of :data:`CONVENTIONS`.
    irregular : tuple of (Reading, str)
        Readings and irregularities of section V.
    seeds : tuple of int
        Random wires of each irregularity.
    """

    name: str
    mesh: int
    readings: tuple[Reading, ...]
    lines: tuple[str, ...]
    conventions: tuple[str, ...]
    irregular: tuple[tuple[Reading, str], ...]
    seeds: tuple[int, ...]


FULL = Scope(
    "full",
    15,
    READINGS,
    tuple(LINES),
    tuple(CONVENTIONS),
    (
        (UNCALIBRATED, HEIGHTS),
        (UNCALIBRATED, ROUGH),
        (Reading("plane", 500), HEIGHTS),
        (Reading("plane", 500), SURFACE),
    ),
    (2021, 2022, 2023),
)
QUICK = Scope(
    "quick",
    9,
    (UNCALIBRATED, Reading("plane", 500)),
    ("hinged", "plane"),
    (),
    ((UNCALIBRATED, ROUGH),),
    (2021, 2022, 2023),
)


def standard(mesh: int, reading: Reading, speed: int = TOP_SPEED, mean: float | None = None) -> str:
    """Return the name of a passage by mesh, reading and speed [km/h]."""
    suffix = "" if mean is None else f"-mean{mean:g}"
    return f"{reading.name}-nad{mesh}-v{speed}{suffix}"


def passages(scope: Scope) -> dict[str, dict[str, Any]]:
    """List the passages by name: the values that differ from the library case.

    Parameters
    ----------
    scope
        How much is wanted.
    """
    wanted = [(m, r, TOP_SPEED) for r in scope.readings for m in MESHES]
    wanted += [(scope.mesh, r, v) for r in scope.readings for v in SPEEDS]
    wanted += [(m, r, TOP_SPEED) for line in scope.lines for r in series(line)
               for m in dict.fromkeys((9, scope.mesh))]  # fmt: skip
    found = {standard(*one): values_of(*one) for one in wanted}
    for speed in SPEEDS[:-1]:
        name = standard(scope.mesh, UNCALIBRATED, speed, OTHER_MEAN)
        found[name] = values_of(scope.mesh, UNCALIBRATED, speed, OTHER_MEAN)
    for name in scope.conventions:
        found[name] = {**values_of(9, UNCALIBRATED, TOP_SPEED), **CONVENTIONS[name][1]}
    return found


def values_of(mesh: int, reading: Reading, speed: int, mean: float | None = None) -> dict[str, Any]:
    """Return the values of a passage that differ from the library case.

    Parameters
    ----------
    mesh
        NAD.
    reading
    speed
        [km/h]
    mean
        Mean force, if another than the library case has at this speed [N].
    """
    values = {"settings.nodes_between_droppers": mesh, **reading.values()}
    if speed != TOP_SPEED:
        level = 70.0 + 0.00097 * speed**2 if mean is None else mean
        values |= {
            "scenario.speed": f"{speed} km/h",
            "scenario.uplift_guess": round(UPLIFT_SHARE * level, 1),
        }
    if mean is not None:
        values["scenario.mean_force"] = mean
    return values


def passage_study(
    variants: Mapping[str, Mapping[str, Any]], changes: Mapping[str, Any] | None = None
) -> Study:
    """Make the study that runs passages.

    Parameters
    ----------
    variants
        Passages by name, as from :func:`passages`.
    changes
        Values replaced in all passages.
    """
    return Study.model_validate(
        {
            "schema": 1,
            "name": "song2021",
            "title": "Passages of Song, Ronnquist, Navik (2021)",
            "base": BASE,
            "overrides": {**NUMERICS, **(changes or {})},
            "axes": {"passage": {"variants": {name: dict(v) for name, v in variants.items()}}},
            "keep_runs": True,
        }
    )
