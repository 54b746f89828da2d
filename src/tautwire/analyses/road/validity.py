"""Is a passage inside the world of its model? Numbers can be finite and still mean nothing.

The model knows a wire that a head pushes from below. It knows no collision with the messenger
wire, no mechanical stop of the pantograph, and a contact only as a stiff spring.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.section import analysed_section
from tautwire.model.plausibility import implausible_inputs, implausible_shape
from tautwire.model.preflight import preflight
from tautwire.results.run import PantographRecord, Run
from tautwire.specs.scenario import TUNING_TOLERANCE

Array = NDArray[np.float64]

FALLEN = 0.5
"""Distance of a raised head from the wire beyond which it follows it no more [m]: longer than the
longest losses of contact (0.2 s at 1 m/s), shorter than the way to the lowered position."""

PIERCED = 0.05
"""Penetration beyond which the head is above the wire instead of pressed to it [m]: the height of a
collector strip and a contact wire together."""

MEAN_FORCE_SHARE = 0.1
"""Share of the acting force by which the mean force may differ before it is told: the benchmark's
pantograph (160 N/m on its roof) differs by 9.6 % at 320 km/h, where it lifts the wire most."""

TUNING_SHARE = 0.05
"""Share of the wanted mean force beyond which the tolerance of its tuning is told."""


def judged(run: Run) -> Run:
    """Return a run whose warnings hold the advice on its case and what is outside the model."""
    case = run.case
    advice = [*preflight(case), *implausible_inputs(case)]
    advice += implausible_shape(case, run.equilibrium)
    told = (*map(str, advice), *_mean_forces(run), *_stops(run), *outside_the_model(run))
    return replace(run, warnings=(*run.warnings, *told))


def _mean_forces(run: Run) -> Iterator[str]:
    """Tell that the mean contact force is far from the force that acts."""
    if run.status != "done":
        return
    case, section = run.case, analysed_section(run)
    for spec, record in zip(case.pantographs, run.pantographs, strict=True):
        inside = section.contains(record.position) & record.active
        stages = sum(spec.stage_forces(case.scenario.air))
        acting = record.uplift_force + stages
        if record.uplift_force <= 0.0 or acting <= 0.0 or not inside.any():
            continue
        mean = float(record.contact_force[inside].mean())
        if abs(mean - acting) > MEAN_FORCE_SHARE * acting:
            off = f"{100.0 * (mean / acting - 1.0):+.1f}".replace("-", "−")
            yield (
                f"mean force: pantograph {record.name!r} presses with {mean:.1f} N in the analysed "
                f"section where {acting:.1f} N act, {off} % (usual: "
                f"within {100.0 * MEAN_FORCE_SHARE:g} %); the spring on its roof takes the rest: "
                f"check the stiffness of its last stage ({spec.stages[-1].stiffness:g} N/m; most "
                "lie between 0 and 200 N/m) and its working_height"
            )


def _stops(run: Run) -> Iterator[str]:
    """Tell which uplift stops were met, when, and by how much."""
    shape, supports = run.equilibrium, run.case.supports
    for row, number in enumerate(shape.support_number.tolist()):
        stop = supports.at(number - 1).stop
        if stop is None or not 1 < number <= run.case.line.spans or not run.time.size:
            continue
        lifted = run.support_uplift[:, row]
        if lifted.max() > stop.gap:
            first, where = int(np.argmax(lifted > stop.gap)), run.case.line.support_in_words(number)
            yield (
                f"uplift stop: the wire meets that of {where} at t = {run.time[first]:.3f} s and "
                f"rises by {1e3 * lifted.max():.1f} mm (gap {1e3 * stop.gap:.1f} mm); give the "
                "stop more room, or lower the uplift"
            )


def outside_the_model(run: Run) -> tuple[str, ...]:
    """Name what a passage did that its model cannot describe.

    Parameters
    ----------
    run : Run
        Also a partial one.

    Returns
    -------
    tuple of str
        One sentence each with place, instant and number; empty for a passage as it should be.
    """
    found = [
        *_uplift(run),
        *(text for record in run.pantographs for text in _head(run, record)),
        *_tuning(run),
    ]
    return tuple(f"outside the model: {text}" for text in found)


def _uplift(run: Run) -> Iterator[str]:
    """Tell that the contact wire is lifted above the messenger wire at a support."""
    if not run.time.size:
        return
    shape = run.equilibrium
    room = _messenger_height(run, shape.support_x) - shape.support_heights
    largest = run.support_uplift.max(axis=0)
    over = np.flatnonzero(largest > room)
    if len(over):
        worst = over[np.argmax((largest - room)[over])]
        yield (
            f"the contact wire rises by {largest[worst]:.2f} m at support "
            f"{shape.support_number[worst]}, where the "
            f"messenger wire hangs {room[worst]:.2f} m above it; the two do not collide in the "
            "model: check the uplift force and the tensions"
        )


def _head(run: Run, record: PantographRecord) -> Iterator[str]:
    """Tell that a head left the wire for good, went through it, or lifts it above the messenger."""
    known = record.active & ~np.isnan(record.gap)
    if not known.any() or record.uplift_force <= 0.0:  # a lowered head is meant to be below
        return
    gap, who = np.where(known, record.gap, 0.0), f"the head of pantograph {record.name!r}"

    def place(row: np.intp) -> str:
        return f"at t = {run.time[row]:.3f} s, x = {record.position[row]:.1f} m"

    low, high = np.argmax(gap), np.argmin(gap)
    if gap[low] > FALLEN:
        yield (
            f"{who} hangs {gap[low]:.2f} m below the wire {place(low)}; the uplift force does not "
            "hold it up: check it, the base spring and the damping of the pantograph"
        )
    if gap[high] < -PIERCED:
        yield (
            f"{who} stands {-gap[high]:.3f} m above the wire that it presses {place(high)}; it has "
            "gone through it: raise settings.contact_stiffness (typical: 50 to 200 kN/m)"
        )
    lifted = np.where(known, record.wire_height - _messenger_height(run, record.position), -np.inf)
    top = np.argmax(lifted)
    if lifted[top] > 0.0:
        yield (
            f"{who} lifts the contact wire {lifted[top]:.2f} m above the messenger wire at rest "
            f"{place(top)}; the two do not collide in the model: check the uplift force"
        )


def _tuning(run: Run) -> Iterator[str]:
    """Tell that the wanted mean force is hardly larger than the tolerance of its tuning."""
    target = run.case.scenario.target_mean_force()
    if target is not None and TUNING_SHARE * target < TUNING_TOLERANCE:
        yield (
            f"the mean force of {target:g} N is met to {TUNING_TOLERANCE:g} N, which is "
            f"{100.0 * TUNING_TOLERANCE / target:.0f} % of it; the uplift force found is "
            "arbitrary: check scenario.mean_force (typical: 70 to 170 N)"
        )


def _messenger_height(run: Run, x: Array) -> Array:
    """Return the height of the lowest messenger wire at rest over some places; inf without one."""
    lowest = np.full(np.shape(x), np.inf)
    for wire in run.equilibrium.of_role("messenger"):
        height = np.interp(x, wire.s, wire.position[:, 2], left=np.inf, right=np.inf)
        lowest = np.minimum(lowest, height)
    return lowest
