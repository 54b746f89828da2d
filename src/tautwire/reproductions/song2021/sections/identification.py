"""What did the authors compute? Readings of what the paper leaves open, against its numbers.

A grid of lines (steady arms, fixing of the messenger wire) and single departures from the library
case, each at four contact stiffnesses on NAD 9. Every passage is read with two filters and three
windows. The changes with the contact stiffness, to which elements of that size add, are judged on
NAD 15; the best readings are computed at the other speeds and on the other meshes as well. Nothing
is fitted: a reading is judged by how many numbers of the text it meets.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.passages import (
    BASE,
    MESHES,
    NUMERICS,
    SPEEDS,
    TOP_SPEED,
    UPLIFT_SHARE,
    passage_study,
)
from tautwire.reproductions.song2021.sections import cutoffs, statics, validation
from tautwire.reproductions.song2021.sections.forces import SHIFTS, comb
from tautwire.reproductions.song2021.sections.mesh import HIGHEST, finer
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

OTHER_MESH = "NAD 15"
"""The departure that is a mesh."""

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
    OTHER_MESH: {"settings.nodes_between_droppers": 15},
    "time step 0.5 ms": {"settings.time_step": "0.5 ms"},
}
"""Single departures from the library case."""

DYNAMIC = ("line.damping", "scenario", "settings.time_step")
"""Values without a part in the elasticity."""

STIFFNESSES = (50, 100, 200, 500)
"""Contact stiffnesses [kN/m]."""

MESH = 9
"""NAD of the grid."""

TREND_MESH = 15
"""NAD on which changes with the contact stiffness are judged, the paper's choice up to 200 Hz."""

ELEMENT_LINES = tuple(
    (mesh, place) for mesh, pair in published.ELEMENT_PASSING.items() for place in pair
)
"""Element passing as (NAD, frequency [Hz])."""

LINES_OF_MESH = (*published.ELEMENT_PASSING[MESH], 2.0 * published.ELEMENT_PASSING[MESH][0])
"""Element passing that the mesh of the grid can show, n = 2 included [Hz]."""

FINALISTS = 12
"""Readings that are computed at all speeds and on all meshes; as many as fill a screen."""

TASK = f"{__name__}:measure"
STATIC_TASK = f"{__name__}:measure_statics"
GROUPS = ("Table 1", "Table 2", "III.B", "NAD 9", "no loss", "III.A", "IV.C")
"""Groups of numbers, in the order of the tables."""

OF_FINALISTS = ("III.A", "IV.C")
"""Groups that only the best readings are judged by; they have no part in the order."""


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


def passage(line: str, stiffness: int, speed: int = TOP_SPEED, mesh: int = MESH) -> str:
    """Return the name of a passage."""
    name = f"{line}; {stiffness} kN/m; {speed} km/h"
    return name if mesh == MESH else f"{name}; NAD {mesh}"


def _values(
    changes: Changes, stiffness: int, speed: int = TOP_SPEED, mesh: int = MESH
) -> dict[str, Any]:
    values = {**changes, "settings.contact_stiffness": f"{stiffness} kN/m"}
    if mesh != MESH:
        values["settings.nodes_between_droppers"] = mesh
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
            passage(name, stiffness): _values(changes, stiffness)
            for name, changes in lines().items()
            for stiffness in STIFFNESSES
        }
    )


def trend_study() -> Study:
    """Make the study of the softest and the stiffest contact of every line of the grid."""
    return passage_study(
        {
            passage(name, k, mesh=TREND_MESH): _values(changes, k, mesh=TREND_MESH)
            for name, changes in lines().items()
            if name not in ALONE
            for k in (STIFFNESSES[0], STIFFNESSES[-1])
        }
    )


def finalist_study(chosen: Sequence[Trial]) -> Study:
    """Make the study of some readings at the other speeds and on the other meshes.

    Parameters
    ----------
    chosen
        Readings; of each line and contact stiffness one is enough.
    """
    every = lines()
    others = [(speed, MESH) for speed in SPEEDS if speed != TOP_SPEED]
    others += [(TOP_SPEED, mesh) for mesh in MESHES if mesh != MESH]
    pairs = dict.fromkeys((one.line, one.stiffness) for one in chosen)
    return passage_study(
        {
            passage(line, k, speed, mesh): _values(every[line], k, speed, mesh)
            for line, k in pairs
            for speed, mesh in others
            if (line in ALONE or mesh != TREND_MESH or k not in (STIFFNESSES[0], STIFFNESSES[-1]))
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
    found = comb(force_spectrum(run, name), spacing, HIGHEST)
    places = dict.fromkeys((*LINES_OF_MESH, *(place for _, place in ELEMENT_LINES)))
    return {
        "table": table,
        "losses": contact_loss(run)[0].count,
        "advised": missed_deviation(run, name, SharpLowpass()).advised,
        "lines": {f"{place:.2f}": found.test(place).stands_out for place in places},
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
        """How many numbers are met, those left out that only the best readings are judged by."""
        return sum(met for group, (met, _) in self.met.items() if group not in OF_FINALISTS)

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


def judge(static: Rows, passages: Rows) -> list[Trial]:
    """Judge every reading, those that meet most numbers first.

    Parameters
    ----------
    static, passages
        Finished rows by name: of the elasticity, and of every other study.
    """
    found: list[Trial] = []
    own = {name: row["values"] for name, row in passages.items()}
    for line in lines():
        for stiffness in STIFFNESSES:
            row = own.get(passage(line, stiffness))
            if row is None:
                continue
            shared = {
                "Table 1": _table_1(static.get(_static_line(line))),
                "III.B": _trend(line, own),
                "NAD 9": _lines(line, row),
                "no loss": (int(row["losses"] == 0), 1),
                "III.A": _element_lines(line, stiffness, own),
                "IV.C": _cutoffs(line, stiffness, own),
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


def _trend(line: str, own: Rows) -> tuple[int, int]:
    """Count the changes from the softest to the stiffest contact that are the paper's."""
    names = [passage(line, k, mesh=TREND_MESH) for k in (STIFFNESSES[0], STIFFNESSES[-1])]
    if not set(names) <= set(own):
        return 0, 0
    wanted = published.STIFFNESS_CHANGES
    first, last = (next(iter(own[name]["table"].values())) for name in names)
    changes = {c: 100.0 * (last[f"std_0_{c}"] / first[f"std_0_{c}"] - 1.0) for c in wanted}
    return sum(abs(changes[c] - wanted[c]) <= CHANGE_WITHIN for c in wanted), len(wanted)


def _lines(line: str, row: Mapping[str, Any]) -> tuple[int, int]:
    if line == OTHER_MESH:  # passes other elements
        return 0, 0
    return sum(row["lines"][f"{place:.2f}"] for place in LINES_OF_MESH), len(LINES_OF_MESH)


def _element_lines(line: str, stiffness: int, own: Rows) -> tuple[int, int]:
    """Count the element lines that stand out on their own mesh and not on the finer one."""
    rows = {mesh: own.get(passage(line, stiffness, mesh=mesh)) for mesh in MESHES}
    if line == OTHER_MESH or None in rows.values():
        return 0, 0
    stands = {mesh: row["lines"] for mesh, row in rows.items() if row is not None}
    met = sum(
        stands[mesh][f"{place:.2f}"] and not stands[finer(mesh)][f"{place:.2f}"]
        for mesh, place in ELEMENT_LINES
    )
    return met, len(ELEMENT_LINES)


def _cutoffs(line: str, stiffness: int, own: Rows) -> tuple[int, int]:
    """Count speeds at which the suggested cut-off is close to 200 Hz and 20 Hz is much lower."""
    rows = [own.get(passage(line, stiffness, speed)) for speed in SPEEDS]
    met, judged = 0, 0
    for one in rows:
        if one is None:
            continue
        numbers = next(iter(one["table"].values()))
        missed = 100.0 * (1.0 - one["advised"] / numbers["std_0_200"])
        below = 100.0 * (1.0 - numbers["std_0_20"] / one["advised"])
        met += (missed <= cutoffs.CLOSE) + (below >= cutoffs.MUCH_LOWER)
        judged += 2
    return met, judged
