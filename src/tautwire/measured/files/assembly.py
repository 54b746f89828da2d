"""Channels put together to a recording: one clock, one way, one direction, gaps kept as gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.measured.channels import Channel
from tautwire.measured.continuity import goes_on
from tautwire.measured.files.source import text_of
from tautwire.measured.recording import Array, Recording
from tautwire.tables.mapping import Side

Mask = NDArray[np.bool_]

QUANTISED = 0.2
"""Share of rows that repeat the reading before from which a clock or odometer counts as coarse."""
HOLE = 5.0
"""Steps of time or way beyond so many usual ones are holes in the record."""
TURN = 2.0
"""Way back that is no jitter of the odometer any more [m]; satellites scatter by less than this."""
_CALM = 5
"""Rows on either side of a jump of the position in which it runs on as usual."""
COARSE, SLOW = 0.4, 5e-3
"""Largest way [m] or, if it is smaller, time [s] between samples of a force measurement (EN 50317,
from memory)."""
SANE_STEP = (1e-7, 1e4)
"""Times between two samples that a recorder can have [s]: 10 MHz to a sample every few hours."""
STANDSTILL = 0.1
"""Speed below which a train counts as standing [m/s]."""


@dataclass
class _Rows:
    """Arrays of one length on their way to a recording, and what was said about them."""

    values: dict[str, Array]
    texts: dict[str, NDArray[np.bytes_]]
    notes: list[str] = field(default_factory=list)
    jumps: list[tuple[float, float]] = field(default_factory=list)

    @property
    def count(self) -> int:
        return len(next(iter(self.values.values())))

    def keep(self, mask: Mask) -> None:
        """Drop rows."""
        if not mask.all():
            self.values = {name: values[mask] for name, values in self.values.items()}
            self.texts = {name: texts[mask] for name, texts in self.texts.items()}

    def get(self, name: str) -> Array | None:
        return self.values.get(name)


def assemble(
    label: str,
    channels: Sequence[Channel],
    *,
    speed: float | None = None,
    positive: Side = "left",
    notes: Sequence[str] = (),
) -> Recording:
    """Put channels together.

    Parameters
    ----------
    label
    channels
        All of one length.
    speed : float m/s, optional
        What the train ran where the file has neither time nor speed, or neither way nor speed.
    positive
        Side of rising chainage on which staggers are positive.
    notes
        What was understood before.

    Raises
    ------
    InputError
        When no time can be told, or the train turns back.
    """
    rows, numbered = _sorted_in(channels, list(notes))
    _refuse_few(label, rows)
    _refuse_empty(label, rows)
    _check_clock(label, rows)
    way = _way(label, rows)
    chainage = rows.get("position")
    time = _clock(label, rows, way, speed, has_force=_has_force(numbered, rows))
    if way is None:
        way = _integrated(rows, time, speed)
    _fill_holes(rows, way)
    rising = chainage is None or chainage[-1] >= chainage[0]
    _describe(rows, rising=rising)
    return _recording(label, rows, numbered, turned=(positive == "left") != rising)


def _sorted_in(
    channels: Sequence[Channel], notes: list[str]
) -> tuple[_Rows, dict[str, list[tuple[int, int, str]]]]:
    """Return channels by name; numbered ones by strip and sensor."""
    rows = _Rows({}, {}, notes)
    numbered: dict[str, list[tuple[int, int, str]]] = {"sensor_force": [], "acceleration": []}
    for channel in channels:
        use = channel.use
        if channel.note:
            notes.append(channel.note)
        if channel.gaps:
            notes.append(f"{use.heading!r}: {channel.gaps}; they stay gaps")
        if channel.texts is not None:
            rows.texts[use.field.name] = channel.texts
            continue
        if np.isnan(channel.values).all():
            continue
        name = use.field.name
        if use.field.is_numbered:
            name = f"{name} {use.column}"
            numbered[use.field.name].append((use.strip or 0, use.sensor or 1, name))
        rows.values[name] = channel.values
    forces = sorted(numbered["sensor_force"])
    strips = {strip for strip, _, _ in forces if strip} or {1}
    numbered["sensor_force"] = [(strip or 1, sensor, name) for strip, sensor, name in forces]
    numbered["acceleration"] = [
        (strip or (sensor if sensor in strips else 1), sensor, name)
        for strip, sensor, name in sorted(numbered["acceleration"])
    ]
    return rows, numbered


def _has_force(numbered: dict[str, list[tuple[int, int, str]]], rows: _Rows) -> bool:
    return bool(numbered["sensor_force"]) or "force" in rows.values


def _refuse_few(label: str, rows: _Rows) -> None:
    if not rows.values or rows.count < 2:
        raise InputError(f"{label}: has fewer than two rows; a record has at least two samples")
    base = next((n for n in ("time", "position", "odometer") if n in rows.values), None)
    if base is None:
        raise InputError(f"{label}: has neither time nor position that can be read")
    known = ~np.isnan(rows.values[base])
    if not known.all():
        rows.notes.append(f"{int((~known).sum())} rows have no {base} and are left out")
        rows.keep(known)
    if rows.count < 2:
        raise InputError(f"{label}: fewer than two rows have a {base}")


_SAYING = ("force", "sensor_force", "acceleration", "height", "stagger", "thickness", "uplift")
"""Channels of which a recording has at least one."""


def _refuse_empty(label: str, rows: _Rows) -> None:
    """Refuse a recording without any reading, with the reason for each column."""
    if not any(name.startswith(_SAYING) for name in rows.values):
        reasons = "; ".join(rows.notes[:5])
        raise InputError(f"{label}: holds no reading of a force or of the wire: {reasons}")


def _check_clock(label: str, rows: _Rows) -> None:
    """See that the clock goes on, and spread the samples of a coarse one."""
    time = rows.get("time")
    if time is None:
        return
    steps = np.diff(time)
    back = np.flatnonzero(steps < 0.0)
    if len(back):
        raise InputError(
            f"{label}: the time goes back by {-steps[back[0]]:.4g} s after row {back[0] + 1} of "
            "the values; give one passage, its rows in the order of time"
        )
    repeated = np.concatenate([[False], steps == 0.0])
    if repeated.mean() > QUANTISED:
        rows.values["time"] = _spread_evenly(time, repeated)
        rows.notes.append(
            f"the clock is coarse: {100 * repeated.mean():.0f} % of the rows repeat the time of "
            "the row before; they are spread evenly between its steps"
        )
    elif repeated.any():
        rows.notes.append(f"{repeated.sum()} rows repeat the time of the row before; left out")
        rows.keep(~repeated)


def _spread_evenly(values: Array, repeated: Mask) -> Array:
    """Interpolate between the first rows of each reading; the last reading goes on as before."""
    first = np.flatnonzero(~repeated)
    index = np.arange(len(values))
    spread = np.interp(index, first, values[first])
    if len(first) > 1:
        rate = (values[first[-1]] - values[first[0]]) / (first[-1] - first[0])
        tail = index > first[-1]
        spread[tail] = values[first[-1]] + rate * (index[tail] - first[-1])
    return spread


def _way(label: str, rows: _Rows) -> Array | None:
    """Return the way run since the first row; None where no position was recorded."""
    for name in ("position", "odometer"):
        _interpolate(rows, name)
    source = "odometer" if "odometer" in rows.values else "position"
    if source not in rows.values:
        return None
    place = rows.values[source]
    rows.values[source] = place = _counted_on(place, source, rows)
    if place[0] == place[-1]:
        raise InputError(f"{label}: the train does not move: the {source} begins and ends alike")
    way = place - place[0] if place[-1] > place[0] else place[0] - place
    back = np.maximum.accumulate(way) - way
    worst = int(back.argmax())
    if back[worst] > TURN:
        raise InputError(
            f"{label}: the {source} turns back by {back[worst]:.1f} m at row {worst + 1} of the "
            "values; give one passage in one direction. Without a time a jump of the chainage is "
            "told from a second passage only where force, height and stagger go on"
        )
    if back[worst] > 0.0:
        rows.notes.append(f"the {source} jitters by up to {back[worst]:.2f} m; it is held there")
    return _steady(rows, np.maximum.accumulate(way), source)


def _counted_on(place: Array, source: str, rows: _Rows) -> Array:
    """Count a position on where it jumps from one row to the next and goes on as before.

    That is an equation of chainage, or a counter that was set; a train that turns goes back row by
    row. A clock that runs on tells a jump back from a second passage that was appended, and a jump
    forward needs no cure then; without a time the readings tell both, see
    :mod:`tautwire.measured.continuity`.
    """
    steps = np.diff(place)
    usual = float(np.median(steps))
    if usual == 0.0 or len(steps) <= 2 * _CALM:
        return place
    back = np.sign(usual) * steps < -TURN
    found = _lone(back, np.sign(usual) * steps > 0.0)
    if "time" not in rows.values:
        ahead = steps / usual > HOLE
        channels = _independent(rows)
        found = np.array(
            [at for at in (*found, *np.flatnonzero(ahead))
             if goes_on(channels, int(at), round(abs(steps[at] / usual)))], dtype=np.int64,
        )  # fmt: skip
        found.sort()
    if not len(found):
        return place
    lost = np.zeros(len(place))
    lost[found + 1] = usual - steps[found]
    first = int(found[0])
    rows.notes.append(
        f"the {source} jumps {'back' if back[first] else 'on'} in {len(found)} places, the first "
        f"by {abs(steps[first]):.1f} m after row {first + 1} of the values; it is counted on from "
        f"there, so that what lies beyond is {abs(lost[first + 1]):.1f} m off what was recorded "
        "(--offset)"
    )
    counted = place + np.cumsum(lost)
    rows.jumps = [(float(abs(counted[at] - counted[0])), float(steps[at])) for at in found]
    return counted


def _lone(back: Mask, runs: Mask) -> NDArray[np.int64]:
    """Return steps back that stand alone among steps forward."""
    near = np.convolve(back, np.ones(2 * _CALM + 1), "same")
    calm = np.convolve(back | ~runs, np.ones(2 * _CALM + 1), "same") <= near
    return np.flatnonzero(back & (near == 1.0) & calm)


def _independent(rows: _Rows) -> list[Array]:
    """Return force, height, stagger and thickness: what goes on where the train does not move."""
    sensors = [values for name, values in rows.values.items() if name.startswith("sensor_force")]
    force = rows.get("force") if not sensors else np.sum(sensors, axis=0)
    others = (rows.get(name) for name in ("height", "stagger", "thickness"))
    return [values for values in (force, *others) if values is not None]


def _interpolate(rows: _Rows, name: str) -> None:
    """Fill the gaps of a position by row, and say so."""
    place = rows.get(name)
    if place is None or not np.isnan(place).any():
        return
    known = ~np.isnan(place)
    rows.notes.append(f"{int((~known).sum())} rows have no {name}; it is interpolated there by row")
    rows.values[name] = np.interp(np.arange(len(place)), np.flatnonzero(known), place[known])


def _steady(rows: _Rows, way: Array, source: str) -> Array:
    """Deal with repeated positions: a coarse odometer is spread, double rows are told."""
    repeated = np.concatenate([[False], np.diff(way) == 0.0])
    if repeated.mean() > QUANTISED and not _stands(rows, repeated):
        rows.notes.append(
            f"the {source} is coarse: {100 * repeated.mean():.0f} % of the rows repeat the "
            "position of the row before; they are spread evenly between its steps"
        )
        return _spread_evenly(way, repeated)
    if repeated.any() and "time" not in rows.values:
        rows.notes.append(
            f"{repeated.sum()} rows repeat the position of the row before and have no time of "
            "their own; left out"
        )
        rows.keep(~repeated)
        return way[~repeated]
    return way


def _stands(rows: _Rows, repeated: Mask) -> bool:
    """Tell whether repeated positions are a train at a standstill."""
    speed = rows.get("speed")
    if speed is not None:
        return bool(np.nanmedian(speed[repeated]) < STANDSTILL)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], repeated, [False]]).astype(np.int8)))
    longest = int(np.diff(edges.reshape(-1, 2), axis=1).max(initial=0))
    return longest > 0.5 * repeated.sum()


def _clock(
    label: str, rows: _Rows, way: Array | None, speed: float | None, *, has_force: bool
) -> Array:
    """Return the time of every row; it is added to the rows."""
    time = rows.get("time")
    if time is None and way is not None:
        running = rows.get("speed")
        if running is not None:
            known = ~np.isnan(running)
            running = np.interp(way, way[known], running[known])
            if running.min() <= STANDSTILL:
                raise InputError(
                    f"{label}: has no time, and its speed falls to {3.6 * running.min():.1f} km/h, "
                    "at which positions tell none; give the part in which the train runs"
                )
            rows.notes.append("there is no time; the rows are timed by position and speed")
            steps = np.diff(way) / (0.5 * (running[1:] + running[:-1]))
        elif speed is not None:
            rows.notes.append(
                f"there is neither time nor speed; the rows are timed by {3.6 * speed:.4g} km/h"
            )
            steps = np.diff(way) / speed
        elif has_force:
            raise InputError(
                f"{label}: has neither time nor speed, so that nothing can be filtered at a "
                "frequency; give the speed, as in --speed '200 km/h'"
            )
        else:
            steps = np.full(len(way) - 1, np.nan)
        time = np.concatenate([[0.0 if len(steps) and np.isfinite(steps[0]) else np.nan], steps])
        time = np.cumsum(time)
    assert time is not None  # one of the two is there
    low, high = SANE_STEP
    if not np.isnan(time[0]) and not low < (step := float(np.median(np.diff(time)))) < high:
        raise InputError(
            f"{label}: the time goes on by {step:.3g} s from row to row; check its column and unit"
        )
    rows.values["time"] = time
    if way is not None:
        rows.values["way"] = way
    return time


def _integrated(rows: _Rows, time: Array, speed: float | None) -> Array | None:
    """Return the way from the speed where no position was recorded."""
    running = rows.get("speed")
    if running is not None:
        known = ~np.isnan(running)
        running = np.interp(time, time[known], running[known])
        rows.notes.append("there is no position; it is the speed integrated, from 0 m on")
    elif speed is not None:
        running = np.full(len(time), speed)
        rows.notes.append(
            f"there is neither position nor speed; the way is that at {3.6 * speed:.4g} km/h"
        )
    else:
        rows.notes.append(
            "there is neither position nor speed: figures are those of the whole; --speed gives "
            "positions"
        )
        return None
    steps = 0.5 * (running[1:] + running[:-1]) * np.diff(time)
    rows.values["way"] = way = np.concatenate([[0.0], np.cumsum(steps)])
    return way


def _fill_holes(rows: _Rows, way: Array | None) -> None:
    """Put rows without readings into holes of the record, so that nothing is bridged unseen."""
    time = rows.values["time"]
    base = time if np.isfinite(time[0]) else way
    if base is None:
        return
    steps = np.diff(base)
    usual = float(np.median(steps))
    ways = np.diff(way) if way is not None else steps
    holes = np.flatnonzero((steps > HOLE * usual) & (ways > HOLE * np.median(ways)))
    if not len(holes) or usual <= 0.0:
        return
    first = int(holes[0])
    unit = "s" if base is time else "m"
    rows.notes.append(
        f"rows are missing in {len(holes)} places, {steps[holes].sum():.4g} {unit} in all, the "
        f"first after {base[first]:.4g} {unit}; they stay gaps"
    )
    counts = np.minimum(np.round(steps[holes] / usual).astype(np.int64) - 1, 1_000_000)
    places = np.repeat(holes + 1, counts)
    carried = {"time", "way", "position"} & set(rows.values)
    inside = np.concatenate([np.arange(1, n + 1) / (n + 1) for n in counts])
    for name, values in rows.values.items():
        if name in carried:
            before, after = values[places - 1], values[places]
            new = before + inside * (after - before)
        else:
            new = np.full(len(places), np.nan)
        rows.values[name] = np.insert(values, places, new)
    for name, texts in rows.texts.items():
        rows.texts[name] = np.insert(texts, places, b"")


def _describe(rows: _Rows, *, rising: bool) -> None:
    """Say what the rows are worth: direction, distance of the rows, what their means hide."""
    if not rising:
        rows.notes.append("the train ran towards falling chainage")
    way, time = rows.get("way"), rows.values["time"]
    if way is None or not np.isfinite(time[0]):
        return
    spacing = float((way[-1] - way[0]) / (len(way) - 1))
    if spacing > COARSE and np.median(np.diff(time)) > 1.01 * SLOW:
        speed = float((way[-1] - way[0]) / (time[-1] - time[0]))
        rows.notes.append(
            f"a row every {spacing:.3g} m: if they are means over that way, they hold at least "
            f"90 % of the force up to {0.25 * speed / spacing:.3g} Hz only (at "
            f"{3.6 * speed:.0f} km/h), and the standard deviation is too small; what lies above is "
            "not judged"
        )


def _recording(
    label: str,
    rows: _Rows,
    numbered: dict[str, list[tuple[int, int, str]]],
    *,
    turned: bool,
) -> Recording:
    count, time = rows.count, rows.values["time"]
    forces = [rows.values[name] for _, _, name in numbered["sensor_force"]]
    strips = [strip for strip, _, _ in numbered["sensor_force"]]
    total = rows.get("force")
    if not forces and total is not None:
        forces, strips, total = [total], [1], None
    accelerations = [rows.values[name] for _, _, name in numbered["acceleration"]]
    stagger = rows.get("stagger")
    marks = _marks(rows, time)
    return Recording(
        label=label,
        time=time,
        forces=np.array(forces).reshape(-1, count),
        force_strips=np.array(strips, dtype=np.int64),
        accelerations=np.array(accelerations).reshape(-1, count),
        acceleration_strips=np.array(
            [strip for strip, _, _ in numbered["acceleration"]], dtype=np.int64
        ),
        speed=rows.get("speed"),
        distance=rows.get("way"),
        stagger=-stagger if stagger is not None and turned else stagger,
        height=rows.get("height"),
        contact_force=total,
        uplift=rows.get("uplift"),
        thickness=rows.get("thickness"),
        chainage=rows.get("position"),
        latitude=rows.get("latitude"),
        longitude=rows.get("longitude"),
        arc=rows.get("arc"),
        comments=_texts(rows.texts.get("comment"), time),
        notes=tuple(rows.notes),
        jumps=tuple(rows.jumps),
        mark_times=marks[0],
        mark_chainages=marks[1],
    )


def _texts(texts: NDArray[np.bytes_] | None, time: Array) -> tuple[tuple[float, str], ...]:
    """Return the filled cells of a column of texts with their times."""
    if texts is None:
        return ()
    filled = np.flatnonzero(texts != b"")
    return tuple((float(time[i]), text_of(bytes(texts[i]))) for i in filled)


def _marks(rows: _Rows, time: Array) -> tuple[Array, Array]:
    """Return times and chainage of the marks that are numbers, and tell of others."""
    found = []
    others = 0
    for instant, text in _texts(rows.texts.get("mark"), time):
        head, _, tail = text.replace(",", ".").partition("+")
        try:
            value = 1e3 * float(head) + float(tail) if tail else float(head)
        except ValueError:
            others += 1
            continue
        found.append((instant, value))
    if others:
        rows.notes.append(f"{others} marks are names without chainage")
    times, places = np.array(found).reshape(-1, 2).T if found else (np.empty(0), np.empty(0))
    return times, places
