"""The passages that the figures and tables of the paper need, as data.

Every passage is the library case ``ac-simple`` with a few values replaced. They are run by the
study engine: in parallel, each on disk as soon as it is finished, resumable.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tautwire.specs.study import Study

BASE = "ac-simple-plane"

MESHES = (9, 12, 15, 18)
"""Nodes between adjacent droppers (NAD) of section III.A."""

STIFFNESSES = (50, 100, 200, 300, 400, 500)
"""Contact stiffnesses of section III.B [kN/m]."""

READINGS = (50, 200, 500)
"""Contact stiffnesses at which every claim is judged [kN/m]: the paper does not state its own."""

SPEEDS = (200, 225, 250, 275, 320)
"""Speeds of Fig. 15 [km/h]."""

TOP_SPEED = 320

FITTING = 500
"""Contact stiffness that meets Table 2 of the paper [kN/m]."""

OTHER_MEAN = 169.0
"""Mean force at all speeds, the other reading of what the paper leaves open [N]."""

UPLIFT_SHARE = 1.0772
"""Uplift force over mean force: first guess, so that few passages are needed."""

CONVENTIONS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "lift": ("arms carry nothing (closure lift, 0 N)", {"supports.closure": "lift"}),
    "swinging": ("arms swing about their far end", {"supports.arm.motion": "swinging"}),
    "messenger": (
        "messenger wire held along the track",
        {"supports.messenger_longitudinal": "fixed"},
    ),
    "weighted": ("wire ends with constant tension", {"line.ends": "weighted"}),
    "damping-0": ("no stiffness-proportional damping", {"line.damping.stiffness": 0.0}),
    "damping-3": ("stiffness-proportional damping 3e-4 s", {"line.damping.stiffness": 3e-4}),
    "dropper": ("droppers of 100 kN/m", {"droppers.stiffness": "100 kN/m"}),
    "half-step": ("time step 0.5 ms", {"settings.time_step": "0.5 ms"}),
    "fine-step": ("time step 0.2 ms", {"settings.time_step": "0.2 ms"}),
}
"""Readings of what the paper leaves open: name, words, values that differ."""

HEIGHTS, SURFACE = "heights", "surface"
"""Irregularities of section V."""

QUICK_CONVENTIONS = ("swinging", "damping-0", "half-step")


@dataclass(frozen=True)
class Scope:
    """How much is computed.

    Attributes
    ----------
    name : str
        ``"full"`` or ``"quick"``.
    mesh : int
        NAD of the studies of stiffness and speed.
    readings : tuple of int
        Contact stiffnesses of the studies of mesh and speed [kN/m].
    conventions : tuple of str
        Names of :data:`CONVENTIONS`.
    irregular : tuple of int
        Contact stiffnesses of section V [kN/m].
    kinds : tuple of str
        Irregularities of section V.
    """

    name: str
    mesh: int
    readings: tuple[int, ...]
    conventions: tuple[str, ...]
    irregular: tuple[int, ...]
    kinds: tuple[str, ...]


FULL = Scope("full", 15, READINGS, tuple(CONVENTIONS), (FITTING, 200, 50), (HEIGHTS, SURFACE))
QUICK = Scope("quick", 9, (FITTING,), QUICK_CONVENTIONS, (FITTING,), (HEIGHTS,))


def standard(mesh: int, stiffness: int, speed: int = TOP_SPEED, mean: float | None = None) -> str:
    """Return the name of a passage by mesh, contact stiffness [kN/m] and speed [km/h]."""
    suffix = "" if mean is None else f"-mean{mean:g}"
    return f"nad{mesh}-k{stiffness}-v{speed}{suffix}"


def convention(name: str, stiffness: int) -> str:
    """Return the name of a passage with another convention, NAD 9 at 320 km/h."""
    return f"{name}-k{stiffness}"


def passages(scope: Scope) -> dict[str, dict[str, Any]]:
    """List the passages by name: the values that differ from the library case.

    Parameters
    ----------
    scope
        How much is wanted.
    """
    found: dict[str, dict[str, Any]] = {}
    wanted = [(9, k, TOP_SPEED) for k in STIFFNESSES]
    wanted += [(scope.mesh, k, TOP_SPEED) for k in STIFFNESSES]
    wanted += [(mesh, k, TOP_SPEED) for k in scope.readings for mesh in MESHES]
    wanted += [(scope.mesh, k, v) for k in scope.readings for v in SPEEDS]
    for mesh, stiffness, speed in wanted:
        found[standard(mesh, stiffness, speed)] = values_of(mesh, stiffness, speed)
    for speed in SPEEDS[:-1]:
        name = standard(scope.mesh, FITTING, speed, OTHER_MEAN)
        found[name] = values_of(scope.mesh, FITTING, speed, OTHER_MEAN)
    for name in scope.conventions:
        for stiffness in (FITTING, 50) if name == "swinging" else (FITTING,):
            changes = {**values_of(9, stiffness, TOP_SPEED), **CONVENTIONS[name][1]}
            found[convention(name, stiffness)] = changes
    return found


def values_of(mesh: int, stiffness: int, speed: int, mean: float | None = None) -> dict[str, Any]:
    """Return the values of a passage that differ from the library case.

    Parameters
    ----------
    mesh
        NAD.
    stiffness
        Contact stiffness [kN/m].
    speed
        [km/h]
    mean
        Mean force, if another than the library case has at this speed [N].
    """
    values: dict[str, Any] = {
        "settings.nodes_between_droppers": mesh,
        "settings.contact_stiffness": f"{stiffness} kN/m",
    }
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
            "overrides": dict(changes or {}),
            "axes": {"passage": {"variants": {name: dict(v) for name, v in variants.items()}}},
            "keep_runs": True,
        }
    )
