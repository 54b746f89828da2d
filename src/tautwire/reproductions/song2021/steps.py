"""Section V, Table 3 and Figs 16-18: how long contact losses last, by time step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.section import analysed_section, time_in_section
from tautwire.reproductions.song2021.claims import Claim, Evidence, least, most
from tautwire.reproductions.song2021.forces import Passages
from tautwire.reproductions.song2021.passages import (
    MESHES,
    STEPS,
    STIFFNESSES,
    irregular,
    standard,
)
from tautwire.results.run import PantographRecord, Run
from tautwire.signals.losses import clip_intervals, loss_intervals

Array = NDArray[np.float64]

COUNTED_1, COUNTED_5, LOCATED_1, LOCATED_5 = (
    "1 ms, counted",
    "0.2 ms, counted",
    "1 ms, located",
    "0.2 ms, located",
)
VARIABLE = "variable step"
ADAPTIVE = "adaptive step"

TOGETHER = 3e-3
"""Losses of two passages closer than this are the same [s]."""

SHORTEST = 1e-3
"""Shorter losses do not count in errors [s]; the shortest in Table 3 lasts 1.41 ms."""

LARGE_ERROR = 50.0
"""An error that shows the constant step to be wrong [%]."""

SMALL_ERROR = 20.0


@dataclass(frozen=True, eq=False)
class Losses:
    """Contact losses of one passage by one way of reading them.

    Attributes
    ----------
    start, end : (n_event,) s
    duration : (n_event,) s
    """

    start: Array
    end: Array
    duration: Array


@dataclass(frozen=True, eq=False)
class LossTable:
    """Table 3.

    Attributes
    ----------
    time : (n_event,) s
        When contact is lost.
    durations : mapping of str to (n_event,) s
        By way of reading; NaN where it does not see the loss.
    """

    time: Array
    durations: Mapping[str, Array]

    def errors(self, name: str, reference: str) -> Array:
        """Return ``|t - t_ref|/t_ref`` [%] of the losses that both ways see, from 1 ms on."""
        own, wanted = self.durations[name], self.durations[reference]
        both = np.isfinite(own) & (np.nan_to_num(wanted) >= SHORTEST)
        return 100.0 * np.abs(own[both] - wanted[both]) / wanted[both]

    def missed(self, name: str, reference: str) -> int:
        """Return the number of losses that the reference sees and the other does not."""
        own, wanted = self.durations[name], self.durations[reference]
        return int(np.sum(np.isnan(own) & np.isfinite(wanted)))


def located(run: Run) -> Losses:
    """Return losses in the analysed section, their limits located between samples."""
    record = run.pantographs[0]
    window = _window(run, record)
    time, gap = run.time[record.active], record.gap[record.active]
    start, end, _ = clip_intervals(*loss_intervals(time, gap), *window)
    return Losses(start, end, end - start)


def counted(run: Run) -> Losses:
    """Return losses as a constant step sees them: samples without contact times the step."""
    record = run.pantographs[0]
    low, high = _window(run, record)
    inside = record.active & (run.time >= low) & (run.time <= high)
    time = run.time[inside]
    lost = np.concatenate([[False], record.gap[inside] >= 0.0, [False]])
    first = np.flatnonzero(lost[1:] & ~lost[:-1])
    last = np.flatnonzero(~lost[1:] & lost[:-1])
    step = float(np.median(np.diff(time)))
    return Losses(
        time[first], time[last - 1] + step, np.asarray((last - first) * step, dtype=np.float64)
    )


def _window(run: Run, record: PantographRecord) -> tuple[float, float]:
    found = time_in_section(run, record, analysed_section(run))
    return found if found is not None else (0.0, 0.0)


def tabulate(columns: Mapping[str, Losses]) -> LossTable:
    """Put the losses that belong together into rows.

    Parameters
    ----------
    columns
        Losses by way of reading.
    """
    every = sorted(
        (float(t), float(u)) for own in columns.values() for t, u in zip(own.start, own.end,
                                                                         strict=True)
    )  # fmt: skip
    groups: list[tuple[float, float]] = []
    for start, end in every:
        if groups and start <= groups[-1][1] + TOGETHER:
            groups[-1] = (groups[-1][0], max(end, groups[-1][1]))
        else:
            groups.append((start, end))
    durations = {name: np.full(len(groups), np.nan) for name in columns}
    for name, own in columns.items():
        for row, (start, end) in enumerate(groups):
            here = (own.start >= start - 1e-12) & (own.start <= end)
            if here.any():
                durations[name][row] = float(own.duration[here].sum())
    return LossTable(np.array([start for start, _ in groups]), durations)


def table(passages: Passages, stiffness: int) -> LossTable | None:
    """Return Table 3 at a contact stiffness [kN/m]; None when a passage is missing."""
    one, five = (irregular(step, stiffness) for step in ("1ms", "0.2ms"))
    if not passages.has(one, five):
        return None
    columns = {
        COUNTED_1: counted(passages.run(one)),
        COUNTED_5: counted(passages.run(five)),
        LOCATED_1: located(passages.run(one)),
        LOCATED_5: located(passages.run(five)),
    }
    for step, label in (("variable", VARIABLE), ("adaptive", ADAPTIVE)):
        name = irregular(step, stiffness)
        if step in STEPS and passages.has(name):
            columns[label] = located(passages.run(name))
    return tabulate(columns)


def claims(passages: Passages, tables: Mapping[int, LossTable]) -> list[Claim]:
    """Judge section V.

    Parameters
    ----------
    passages
    tables
        By contact stiffness [kN/m].
    """
    tables = {k: own for k, own in tables.items() if own.errors(COUNTED_1, LOCATED_1).size}
    return [
        _no_loss(passages),
        _large_error(tables),
        _missed(tables),
        _beyond(tables),
        _fine_step(tables),
        _method(tables),
    ]


def _no_loss(passages: Passages) -> Claim:
    found = tuple(
        most(
            f"NAD {m}, {k} kN/m",
            "contact losses on the ideal line",
            located(passages.run(standard(m, k))).start.size,
            0.0,
            "",
        )
        for m in (MESHES[0], MESHES[-2])
        for k in STIFFNESSES
        if passages.has(standard(m, k))
    )
    text = "Simulations in ideal conditions cannot reproduce contact loss."
    return Claim("losses-ideal", "V.B", text, found)


def _references(own: LossTable) -> list[str]:
    return [name for name in (LOCATED_1, VARIABLE) if name in own.durations]


def _condition(stiffness: int, reference: str) -> str:
    return f"{stiffness} kN/m, beside {reference}"


def _large_error(tables: Mapping[int, LossTable]) -> Claim:
    found: list[Evidence] = []
    for k, own in tables.items():
        for name in _references(own):
            errors = own.errors(COUNTED_1, name)
            largest = float(errors.max(initial=0.0))
            where = _condition(k, name)
            found.append(Evidence(where, "largest error of 1 ms, counted", largest, "%",
                                  low=LARGE_ERROR, published=75.63))  # fmt: skip
    text = (
        "The constant step of 1 ms errs in the duration of losses by up to 75.63 % (limit here: "
        f"some loss errs by at least {LARGE_ERROR:g} %)."
    )
    return Claim("losses-1ms", "V.B", text, tuple(found))


def _missed(tables: Mapping[int, LossTable]) -> Claim:
    found = tuple(
        least(_condition(k, name), "losses it sees and 1 ms, counted, does not",
              own.missed(COUNTED_1, name), 1, "")
        for k, own in tables.items()
        for name in _references(own)
        if name != LOCATED_1
    )  # fmt: skip
    text = "Losses that the variable step sees are not captured by the constant step of 1 ms."
    remark = (
        "Needs the variable step itself: an instant located in the run of the constant step "
        "belongs to a loss which that run has seen."
    )
    return Claim("losses-missed", "V.B", text, found, remark)


def _beyond(tables: Mapping[int, LossTable]) -> Claim:
    found = tuple(
        least(_condition(k, name), "losses of 0.2 ms that it does not see",
              own.missed(name, COUNTED_5), 1, "")
        for k, own in tables.items()
        for name in _references(own)
    )  # fmt: skip
    text = "Some losses of the constant step of 0.2 ms are not captured by the variable step."
    return Claim("losses-beyond", "V.B", text, found)


def _fine_step(tables: Mapping[int, LossTable]) -> Claim:
    found: list[Evidence] = []
    for k, own in tables.items():
        for name in _references(own):
            errors = own.errors(COUNTED_5, name)
            where = _condition(k, name)
            found.append(most(where, "largest difference of 0.2 ms, counted",
                              float(errors.max(initial=0.0)), SMALL_ERROR))  # fmt: skip
            median = float(np.median(errors)) if errors.size else float("nan")
            found.append(Evidence(where, "median difference of 0.2 ms, counted", median, "%"))
    text = "Durations of the constant step of 0.2 ms and of the variable step differ by up to 20 %."
    return Claim("losses-5khz", "V.B", text, tuple(found))


def _method(tables: Mapping[int, LossTable]) -> Claim:
    found: list[Evidence] = []
    for k, own in tables.items():
        for name in _references(own):
            medians = [float(np.median(own.errors(way, LOCATED_5))) for way in (name, COUNTED_1)]
            where = _condition(k, name)
            text = "median error against 0.2 ms, located: its own over that of 1 ms, counted"
            found.append(most(where, text, medians[0] / medians[1], 0.5, "1"))
    text = "Locating the instants captures durations without a high sampling frequency (VI.5)."
    return Claim("losses-method", "V.B, VI.5", text, tuple(found))
