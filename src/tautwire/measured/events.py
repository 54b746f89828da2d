"""Events along the line: losses of contact, high forces, hard spots.

A hard spot is a place at which the contact wire gives the head a blow: a clamp, an insulator, a
kink. Two signs are read:

* where the head has accelerometers, its vertical acceleration goes beyond a limit;
* else, or where none of them says anything, the contact force rises above its mean over some metres
  by more than a limit.

No clause of a standard gives the limits here. By default they are a multiple of what is usual in
the run, so that the places are told which are hard for this line and speed; an absolute limit of
the acceleration can be given.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.recording import Array, Recording, Step

HARD_TIMES = 7.0
"""Hard is what exceeds this multiple of the usual deviation: one in 1e6 normal samples reaches 5,
and so does the force of computed passages with losses of contact. Chosen, not from a standard."""
HARD_LENGTH = 3.0
"""Length of line over which a force is compared with its mean [m]: longer than the blow of a clamp,
and less than half of the usual distance of droppers, whose rise and fall is no hard spot."""
LEAST_FORCE = 40.0
"""Rise of the force that no quiet run calls hard [N]: a quarter of usual contact forces. Chosen."""
LEAST_ACCELERATION = 20.0
"""The same of the acceleration [m/s2]: twice that of gravity, which strips vibrate by everywhere.
Chosen."""
APART = 5.0
"""Signs closer than this are one place [m]: the strips of a head follow each other within a metre,
and a head rings over some metres."""
APART_TIME = 0.1
"""The same where no way is known [s]: :data:`APART` at 50 m/s, a middling speed of measuring
trains. Chosen: a head rings as long at any speed; a slower one tells closer places apart."""
_GLITCH = 1.5e-3
"""Interval of samples [s] below which a single one of an accelerometer is no blow: a head of
kilograms on a wire is struck for at least 3 ms."""
_FEWEST = 3
"""Samples within :data:`HARD_LENGTH` that a blow can be told by."""

Kind = Literal["loss", "high force", "hard spot"]


@dataclass(frozen=True)
class Event:
    """A stretch of time in which the force or the acceleration was beyond a level.

    Attributes
    ----------
    kind : str
        ``"loss"``, ``"high force"`` or ``"hard spot"``.
    start, end : float s
    position : float m
        Where a loss or a high force begins; where a hard spot is hardest. NaN where neither way nor
        chainage was recorded.
    extreme : float
        Of the force, or of the acceleration of a hard spot; of its force, what it has above the
        mean around it.
    unit : str
        ``"N"`` or ``"m/s^2"``.
    """

    kind: Kind
    start: float
    end: float
    position: float
    extreme: float
    unit: str = "N"


def force_events(
    time: Array,
    position: Array,
    force: Array,
    *,
    loss_below: float,
    high_above: float,
    shortest: float = 0.0,
) -> tuple[Event, ...]:
    """List losses of contact and forces above a limit, in the order of time.

    Parameters
    ----------
    time, position, force : (n,) s, m, N
    loss_below : float N
        A force at or below it counts as loss; sensors rarely return to exactly zero.
    high_above : float N
    shortest : float s
        Events that are shorter are left out.
    """
    found: list[Event] = []
    kinds: tuple[tuple[Kind, NDArray[np.bool_]], ...] = (
        ("loss", force <= loss_below),
        ("high force", force > high_above),
    )
    for kind, beyond in kinds:
        for first, after in _runs(beyond):
            start, end = _start_and_end(time, first, after)
            if end - start < shortest:
                continue
            values = force[first:after]
            extreme = values.min() if kind == "loss" else values.max()
            found.append(Event(kind, start, end, float(position[first]), float(extreme)))
    return tuple(sorted(found, key=lambda event: event.start))


def hard_spots(
    recording: Recording, force: Array | None, limit: float | None
) -> tuple[tuple[Event, ...], tuple[Step, ...]]:
    """List hard spots in the order of time, and how they were looked for.

    Parameters
    ----------
    recording
    force : (n,) N or None
        Contact force, unfiltered, at the samples of the recording; looked at where no accelerometer
        of the head is live.
    limit : float m/s2 or None
        Of the acceleration; by default :data:`HARD_TIMES` times what is usual in the run.

    Returns
    -------
    events : tuple of Event
    steps : tuple of Step
        One, which says what share of the samples was examined, by what, and which accelerometers
        were left out; none for a recording without force and accelerometers.
    """
    if force is None and not len(recording.accelerations):
        return (), ()
    if recording.is_live.any():
        signs, parameters = _blows(recording, limit)
    elif force is not None and _FEWEST * recording.spacing <= HARD_LENGTH:
        signs, parameters = _rises(recording, force)
    else:
        signs, parameters = [], {"by": "nothing", "for_want_of": _missing(recording, force)}
    reads = [~np.isnan(sign.values) for sign in signs]
    share = float(np.any(reads, axis=0).mean()) if reads else 0.0
    step = Step("hard spots", {**parameters, "examined_share": share, **_left_out(recording)})
    return tuple(_merged(recording, signs)), (step,)


def _left_out(recording: Recording) -> dict[str, str]:
    """Name the accelerometers that say nothing."""
    names = [
        recording.accelerometer_name(row) for row in np.flatnonzero(~recording.is_live).tolist()
    ]
    return {"left_out": ", ".join(names)} if names else {}


def _missing(recording: Recording, force: Array | None) -> str:
    """Say what a look for hard spots would need."""
    if force is None:
        return "an accelerometer whose readings differ, or a force"
    if np.isnan(recording.spacing):
        return "a way, to take the mean of the force over"
    return (
        f"rows at most {HARD_LENGTH / _FEWEST:g} m apart, or an accelerometer (here rows are "
        f"{recording.spacing:.3g} m apart)"
    )


@dataclass(frozen=True, eq=False)
class _Sign:
    """How hard every sample is, in its unit, and where that is hard."""

    values: Array
    limit: float
    unit: str


def _blows(recording: Recording, limit: float | None) -> tuple[list[_Sign], dict[str, Any]]:
    """Return the accelerations of the strips against a limit, and how they were looked at."""
    signs, limits = [], {}
    for strip in sorted(set(recording.acceleration_strips.tolist())):
        values = recording.strip_acceleration(strip)
        if values is None:
            continue
        values = np.abs(_without_glitches(values - np.nanmedian(values), recording.interval))
        own = max(HARD_TIMES * _usual(values), LEAST_ACCELERATION) if limit is None else limit
        limits[strip] = own
        signs.append(_Sign(values, own, "m/s^2"))
    return signs, {"by": "acceleration of the head", "limit_m_s2": limits, **_origin(limit)}


def _rises(recording: Recording, force: Array) -> tuple[list[_Sign], dict[str, Any]]:
    """Return what the force has above its mean over a length against a limit, and how."""
    rise = force - _mean_around(force, round(0.5 * HARD_LENGTH / recording.spacing))
    limit = max(HARD_TIMES * _usual(np.abs(rise)), LEAST_FORCE)
    parameters = {"by": "force above its mean", "over_m": HARD_LENGTH, "limit_n": limit}
    return [_Sign(rise, limit, "N")], {**parameters, **_origin(None)}


def _origin(limit: float | None) -> dict[str, str]:
    """Say where a limit comes from."""
    usual = f"{HARD_TIMES:g} times the usual deviation, chosen here, no clause of a standard"
    return {"source": usual if limit is None else "given"}


def _usual(values: Array) -> float:
    """Return the standard deviation that normal values of this median size have."""
    known = values[~np.isnan(values)]
    return 1.4826 * float(np.median(known)) if len(known) else float("nan")


def _without_glitches(values: Array, interval: float) -> Array:
    """Take out what a single sample shows, where samples are closer than a blow is long."""
    from scipy.ndimage import median_filter

    if not interval < _GLITCH:
        return values
    known = np.isfinite(values)
    smooth = median_filter(np.where(known, values, 0.0), 3, mode="nearest")
    return np.where(known, smooth, np.nan)


def _mean_around(values: Array, half: int) -> Array:
    """Return the mean over some samples to either side, of those that are known."""
    known = np.isfinite(values)
    window = np.ones(2 * half + 1)
    total = np.convolve(np.where(known, values, 0.0), window, "same")
    count = np.convolve(known.astype(float), window, "same")
    return np.divide(total, count, out=np.full(len(values), np.nan), where=count > 0.5)


def _merged(recording: Recording, signs: list[_Sign]) -> Iterator[Event]:
    """Yield one event per place, the hardest of its signs."""
    way, apart = _way(recording)
    place = _places(recording)
    runs = [(*run, sign) for sign in signs for run in _runs(sign.values > sign.limit)]
    groups: list[list[tuple[int, int, _Sign]]] = []
    for run in sorted(runs, key=lambda run: run[0]):
        if groups and way[run[0]] - max(way[after - 1] for _, after, _ in groups[-1]) < apart:
            groups[-1].append(run)
        else:
            groups.append([run])
    for group in groups:
        first, after = group[0][0], max(after for _, after, _ in group)
        sign = max((one for _, _, one in group), key=lambda one: _peak(one, first, after))
        at = first + int(np.nanargmax(sign.values[first:after]))
        start, end = _start_and_end(recording.time, first, after)
        extreme = float(sign.values[at])
        yield Event("hard spot", start, end, float(place[at]), extreme, sign.unit)


def _way(recording: Recording) -> tuple[Array, float]:
    """Return what tells places apart, way [m] or else time [s], and by how much."""
    if recording.distance is not None:
        return recording.distance, APART
    if recording.chainage is not None:
        return (1.0 if recording.is_rising else -1.0) * recording.chainage, APART
    return recording.time, APART_TIME


def _places(recording: Recording) -> Array:
    """Return chainage or way [m]; NaN where neither was recorded."""
    known = recording.chainage if recording.chainage is not None else recording.distance
    return np.full(len(recording.time), np.nan) if known is None else known


def _peak(sign: _Sign, first: int, after: int) -> float:
    return float(np.nanmax(sign.values[first:after])) / sign.limit


def _start_and_end(time: Array, first: int, after: int) -> tuple[float, float]:
    """Return the time of the first sample of an event and that of the one after its last [s]."""
    return float(time[first]), float(time[min(after, len(time) - 1)])


def _runs(beyond: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return where runs of true samples begin and what comes after them."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], beyond, [False]]).astype(np.int8)))
    return [(int(first), int(after)) for first, after in edges.reshape(-1, 2)]
