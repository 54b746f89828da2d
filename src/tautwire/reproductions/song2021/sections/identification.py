"""What did the authors compute? Readings of what the paper leaves open, against its numbers.

A grid of lines (steady arms, fixing of the messenger wire) and single departures from the library
case, each at four contact stiffnesses. Every passage is read with two filters and three windows.
Nothing is fitted: a reading is judged by how many numbers of the text it meets.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.passages import (
    BASE,
    NUMERICS,
    SPEEDS,
    TOP_SPEED,
    UPLIFT_SHARE,
    passage_study,
)
from tautwire.reproductions.song2021.sections import cutoffs, statics, validation
from tautwire.reproductions.song2021.sections.forces import SHIFTS, comb
from tautwire.reproductions.song2021.sections.stiffness import CHANGE_WITHIN
from tautwire.specs.case import Case
from tautwire.specs.study import Study

Changes = Mapping[str, Any]
Rows = Mapping[str, Mapping[str, Any]]

ARMS: Mapping[str, Changes] = {
    "10°": {},
    "0°": {"supports.arm.angle": "0 deg"},
    "5°": {"supports.arm.angle": "5 deg"},
    "15°": {"supports.arm.angle": "15 deg"},
    "20°": {"supports.arm.angle": "20 deg"},
    "at height": {"supports.closure": "height"},
    "no load": {"supports.closure": "lift"},
    "plane": {"supports.closure": "height", "supports.arm.motion": "vertical"},
}
MESSENGER: Mapping[str, Changes] = {
    "free": {},
    "fixed": {"supports.messenger_longitudinal": "fixed"},
}
FACTORS: Mapping[str, Mapping[str, Changes]] = {
    "arms": ARMS,
    "messenger wire": MESSENGER,
}
"""What is varied on the grid; the first level of each is that of the library case."""

LIBRARY = "10°, free"

ALONE: Mapping[str, Changes] = {
    "no stiffness-proportional damping": {"line.damping.stiffness": 0.0},
    "stiffness-proportional damping 3e-4 s": {"line.damping.stiffness": 3e-4},
    "no mass-proportional damping": {"line.damping.mass": 0.0},
    "droppers 100 kN/m": {"droppers.stiffness": "100 kN/m"},
    "no clamps, no dropper mass": {
        "droppers.clamp_contact": 0.0,
        "droppers.clamp_messenger": 0.0,
        "droppers.mass": 0.0,
    },
    "arm of three times the mass": {"supports.arm.mass": "2.19 kg/m"},
    "messenger wire not staggered": {"supports.messenger_stagger": 0.0},
    "wire ends with constant tension": {"line.ends": "weighted"},
    "mean force 169 N": {"scenario.mean_force": 169.0},
    "NAD 15": {"settings.nodes_between_droppers": 15},
    "time step 0.5 ms": {"settings.time_step": "0.5 ms"},
}
"""Single departures from the library case."""

DYNAMIC = ("line.damping", "scenario", "settings.time_step")
"""Values without a part in the elasticity."""

STIFFNESSES = (50, 100, 200, 500)
"""Contact stiffnesses [kN/m]."""

LINES_NAD_9 = (*published.ELEMENT_PASSING[9], 2.0 * published.ELEMENT_PASSING[9][0])
"""Element passing that the mesh of the grid can show [Hz]."""

FINALISTS = 12
"""Readings whose speeds are computed for the claims about the cut-off."""

TASK = f"{__name__}:measure"
STATIC_TASK = f"{__name__}:measure_statics"
GROUPS = ("Table 1", "Table 2", "III.B", "lines", "no loss", "IV.C")
"""Groups of numbers, in the order of the tables."""


def lines() -> dict[str, dict[str, Any]]:
    """Return all lines by name: the grid, then the single departures."""
    grid = {
        ", ".join(levels): {
            path: value
            for factor, level in zip(FACTORS.values(), levels, strict=True)
            for path, value in factor[level].items()
        }
        for levels in itertools.product(*FACTORS.values())
    }
    return {**grid, **{name: dict(changes) for name, changes in ALONE.items()}}


def passage(line: str, stiffness: int, speed: int = TOP_SPEED) -> str:
    """Return the name of a passage."""
    return f"{line}; {stiffness} kN/m; {speed} km/h"


def _values(changes: Changes, stiffness: int, speed: int) -> dict[str, Any]:
    values = {**changes, "settings.contact_stiffness": f"{stiffness} kN/m"}
    if speed != TOP_SPEED:
        values |= {
            "scenario.speed": f"{speed} km/h",
            "scenario.uplift_guess": round(UPLIFT_SHARE * (70.0 + 0.00097 * speed**2), 1),
        }
    return values


def grid_study() -> Study:
    """Make the study of all lines and contact stiffnesses at 320 km/h."""
    return passage_study(
        {
            passage(name, stiffness): _values(changes, stiffness, TOP_SPEED)
            for name, changes in lines().items()
            for stiffness in STIFFNESSES
        }
    )


def speed_study(chosen: Sequence[Trial]) -> Study:
    """Make the study of the other speeds of some readings."""
    every = lines()
    pairs = dict.fromkeys((one.line, one.stiffness) for one in chosen)
    return passage_study(
        {
            passage(line, stiffness, speed): _values(every[line], stiffness, speed)
            for line, stiffness in pairs
            for speed in SPEEDS
            if speed != TOP_SPEED
        }
    )


def static_study() -> Study:
    """Make the study of the elasticity; damping, mean force and time step have no part in it."""
    variants = {
        name: {"title": name, **changes}
        for name, changes in lines().items()
        if not any(path.startswith(DYNAMIC) for path in changes)
    }
    return Study.model_validate(
        {
            "schema": 1,
            "name": "song2021-elasticity",
            "base": BASE,
            "overrides": dict(NUMERICS),
            "axes": {"line": {"variants": variants}},
        }
    )


def measure(case: Case, _keep_run: bool) -> tuple[dict[str, Any], None]:  # noqa: FBT001
    """Run a passage and return the numbers that claims are judged by.

    Parameters
    ----------
    case
    _keep_run
        Without effect: histories are not kept.
    """
    from tautwire.analyses.force.contact_loss import contact_loss
    from tautwire.analyses.force.cutoff import missed_deviation
    from tautwire.analyses.force.spectrum import force_spectrum
    from tautwire.analyses.force.statistics import contact_statistics
    from tautwire.analyses.road.pipeline import run_case
    from tautwire.signals.filters import SharpLowpass

    run = run_case(case)
    name = run.pantographs[0].name
    first, last = case.resolved_section()
    table: dict[str, dict[str, float]] = {}
    for shift in (0, *SHIFTS):
        window = (first + shift, last + shift)
        if window[0] < 1 or window[1] > case.line.spans:
            continue
        entry = contact_statistics(run, section=window).pantograph()
        for kind, part in entry.filtered.items():
            bands = {f"std_{band}": value for band, value in part.standard_deviations.items()}
            table[f"{kind}, spans {window[0]} to {window[1]}"] = {
                "mean": part.mean, "maximum": part.maximum, "minimum": part.minimum, **bands
            }  # fmt: skip
    spacing = case.scenario.speed / case.line.span_lengths()[0]
    found = comb(force_spectrum(run, name), spacing, 350.0)
    return {
        "table": table,
        "losses": contact_loss(run)[0].count,
        "advised": missed_deviation(run, name, SharpLowpass()).advised,
        "lines": [
            {"ratio": test.ratio, "limit": test.limit}
            for test in (found.test(frequency) for frequency in LINES_NAD_9)
        ],
    }, None


def measure_statics(case: Case, _keep_run: bool) -> tuple[dict[str, Any], None]:  # noqa: FBT001
    """Find the shape and return the elasticity of the middle span by load [mm/N].

    Parameters
    ----------
    case
    _keep_run
        Without effect.
    """
    _, found = statics.elasticities(case)
    return {"elasticity": {f"{load:g} N": list(values) for load, values in found.items()}}, None


@dataclass(frozen=True)
class Trial:
    """A reading and the numbers of the paper that it meets.

    Attributes
    ----------
    line : str
    stiffness : int
        Contact stiffness [kN/m].
    reading : str
        Filter and window.
    numbers : mapping of str to float
        Of Table 2 [N].
    met : mapping of str to (int, int)
        Numbers met and numbers judged, by group of :data:`GROUPS`.
    """

    line: str
    stiffness: int
    reading: str
    numbers: Mapping[str, float]
    met: Mapping[str, tuple[int, int]]

    @property
    def total(self) -> int:
        """How many numbers are met, those of other speeds left out, which only some have."""
        return sum(met for group, (met, _) in self.met.items() if group != "IV.C")

    def as_dict(self) -> dict[str, Any]:
        """Return the reading as plain data for JSON."""
        return {
            "line": self.line,
            "contact_stiffness_kn_per_m": self.stiffness,
            "reading": self.reading,
            "table_2_n": {name: self.numbers[name] for name in published.QUANTITIES},
            "met": {group: list(pair) for group, pair in self.met.items()},
            "total": self.total,
        }

    @property
    def largest_deviation(self) -> float:
        """Largest relative deviation of a standard deviation of Table 2."""
        return max(
            abs(self.numbers[n] / v - 1.0)
            for n, v in published.PAPER.items()
            if n.startswith("std")
        )


def judge(grid: Rows, static: Rows, speeds: Rows) -> list[Trial]:
    """Judge every reading, those that meet most numbers first.

    Parameters
    ----------
    grid, static, speeds
        Finished rows of the three studies by name; the last may be empty.
    """
    found: list[Trial] = []
    for line in lines():
        rows = {k: grid[passage(line, k)]["values"] for k in STIFFNESSES
                if passage(line, k) in grid}  # fmt: skip
        for stiffness, row in rows.items():
            shared = {
                "Table 1": _table_1(static.get(_static_line(line))),
                "III.B": _trend(rows),
                "lines": _lines(row, line),
                "no loss": (int(row["losses"] == 0), 1),
                "IV.C": _cutoffs(line, stiffness, row, speeds),
            }
            for reading, numbers in row["table"].items():
                met = {**shared, "Table 2": _table_2(numbers)}
                found.append(Trial(line, stiffness, reading, numbers, {g: met[g] for g in GROUPS}))
    return sorted(found, key=_order)


def _order(one: Trial) -> tuple[float, float]:
    return -one.total, one.largest_deviation


def finalists(every: Sequence[Trial]) -> list[Trial]:
    """Choose the readings whose speeds are computed: the best, the library's and the plane ones."""
    best: dict[tuple[str, int], Trial] = {}
    for one in every:
        best.setdefault((one.line, one.stiffness), one)
    named = [(LIBRARY, 50), *(("plane, free", k) for k in (200, 500))]
    return [*itertools.islice(best.values(), FINALISTS), *(best[n] for n in named if n in best)]


def levels(every: Sequence[Trial]) -> Iterator[tuple[str, str, Trial]]:
    """Yield what is varied, its value, and the best reading with it: what fixing it costs.

    Parameters
    ----------
    every
        Readings.
    """
    choices: list[tuple[str, str, Callable[[Trial], bool]]] = [
        (factor, level, lambda t, n=number, own=level: t.line.split(", ")[n] == own)
        for number, (factor, own_levels) in enumerate(FACTORS.items())
        for level in own_levels
    ]
    choices += [
        ("contact stiffness", f"{k} kN/m", lambda t, own=k: t.stiffness == own) for k in STIFFNESSES
    ]
    grid = sorted((t for t in every if t.line not in ALONE), key=_order)
    choices += [
        ("filter and window", own, lambda t, own=own: t.reading == own)
        for own in dict.fromkeys(t.reading for t in grid)
    ]
    for factor, level, belongs in choices:
        best = next(filter(belongs, grid), None)
        if best is not None:
            yield factor, level, best


def _static_line(line: str) -> str:
    """Return the line with the same elasticity that was computed."""
    changes = lines()[line]
    return LIBRARY if any(path.startswith(DYNAMIC) for path in changes) else line


def _table_1(row: Mapping[str, Any] | None) -> tuple[int, int]:
    """Count the elasticities met under the load that meets most; the paper does not state it."""
    if row is None:
        return 0, len(published.ELASTICITY_PAPER)
    return max(
        sum(abs(own / wanted - 1.0) <= statics.ELASTICITY_WITHIN for own, wanted in
            zip(values, published.ELASTICITY_PAPER, strict=True))
        for values in row["values"]["elasticity"].values()
    ), len(published.ELASTICITY_PAPER)  # fmt: skip


def _table_2(numbers: Mapping[str, float]) -> tuple[int, int]:
    met = sum(
        abs(numbers[name] / wanted - 1.0)
        <= validation.WITHIN.get(name, validation.DEVIATION_WITHIN)
        for name, wanted in published.PAPER.items()
    )
    return met, len(published.PAPER)


def _trend(rows: Mapping[int, Mapping[str, Any]]) -> tuple[int, int]:
    """Count the changes from the softest to the stiffest contact that are the paper's."""
    wanted = published.STIFFNESS_CHANGES
    if not {STIFFNESSES[0], STIFFNESSES[-1]} <= set(rows):
        return 0, len(wanted)
    first, last = (next(iter(rows[k]["table"].values())) for k in (STIFFNESSES[0], STIFFNESSES[-1]))
    changes = {c: 100.0 * (last[f"std_0_{c}"] / first[f"std_0_{c}"] - 1.0) for c in wanted}
    return sum(abs(changes[c] - wanted[c]) <= CHANGE_WITHIN for c in wanted), len(wanted)


def _lines(row: Mapping[str, Any], line: str) -> tuple[int, int]:
    if line == "NAD 15":  # passes other elements
        return 0, 0
    return sum(test["ratio"] > test["limit"] for test in row["lines"]), len(LINES_NAD_9)


def _cutoffs(line: str, stiffness: int, row: Mapping[str, Any], speeds: Rows) -> tuple[int, int]:
    """Count speeds at which the suggested cut-off is close to 200 Hz and 20 Hz is much lower."""
    rows = [row, *(speeds[passage(line, stiffness, v)]["values"] for v in SPEEDS
                   if passage(line, stiffness, v) in speeds)]  # fmt: skip
    met = 0
    for one in rows:
        numbers = next(iter(one["table"].values()))
        missed = 100.0 * (1.0 - one["advised"] / numbers["std_0_200"])
        below = 100.0 * (1.0 - numbers["std_0_20"] / one["advised"])
        met += (missed <= cutoffs.CLOSE) + (below >= cutoffs.MUCH_LOWER)
    return met, 2 * len(rows)
