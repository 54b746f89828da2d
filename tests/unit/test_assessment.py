"""Checks against limits, and the file of limits itself."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.assessment.checks import Check, checks
from tautwire.assessment.limits import Limits, load_limits
from tautwire.errors import InputError
from tautwire.report.parts.words import readable
from tautwire.results.accuracy import Accuracy
from tautwire.results.statistics import ContactLoss, LossEvent, RunStatistics
from tautwire.specs.case import Case
from tautwire.specs.line.support import UpliftStop

from .synthetic import make_case, make_run


@pytest.fixture(scope="module")
def statistics() -> RunStatistics:
    """Statistics of a passage at 320 km/h with a mean force near 169 N."""
    return contact_statistics(make_run())


@pytest.fixture(scope="module")
def case() -> Case:
    """The case of the passage."""
    return make_case()


def by_name(rows: tuple[Check, ...], name: str) -> list[Check]:
    """Return the checks whose name begins with a text."""
    return [row for row in rows if row.name.startswith(name)]


def test_values_have_the_digits_that_their_errors_leave(
    statistics: RunStatistics, case: Case
) -> None:
    """A value is told with its numerical error and no digit more; where none is known, as ever."""
    name, headline = statistics.pantographs[0].name, statistics.pantographs[0].headline
    widths = {f"{name}/{headline.kind}/maximum": 12.0, "uplift": 0.0033}
    accuracy = Accuracy("estimate", "so", 1, 2, 0.0, widths)
    rows = checks(statistics, case, free_uplift=0.12, accuracy=accuracy)
    errors = {row.name: row.error for row in rows}
    assert sum(np.isfinite(error) for error in errors.values()) == 2
    [largest] = [row for row in rows if row.error == 12.0]
    assert largest.value == headline.maximum
    told = readable(largest.value, largest.unit, largest.error)
    assert told == f"{headline.maximum:.0f} ± 12\N{NO-BREAK SPACE}N"
    [uplift] = by_name(rows, "largest uplift")
    assert readable(0.0518, uplift.unit, uplift.error) == "52 ± 4\N{NO-BREAK SPACE}mm"
    assert readable(headline.mean, "N") == f"{headline.mean:.1f}\N{NO-BREAK SPACE}N"
    assert all(np.isnan(row.error) for row in checks(statistics, case))


def tuned(target: float, mean: float, statistics: RunStatistics) -> Check:
    """Return the check of the upper curve for a mean force tuned to a target at 320 km/h."""
    case = make_case().with_(**{"scenario.speed": 320.0 / 3.6, "scenario.mean_force": target})
    entry = statistics.pantographs[0]
    filtered = {kind: replace(part, mean=mean) for kind, part in entry.filtered.items()}
    changed = replace(statistics, pantographs=(replace(entry, filtered=filtered),))
    [upper] = by_name(checks(changed, case), "mean contact force, upper")
    return upper


@pytest.mark.parametrize(
    ("target", "mean", "within"),
    [
        (169.328, 169.42, True),
        (169.328, 169.44, False),
        (169.4, 169.42, False),
        (160.0, 169.42, True),
        (160.0, 169.3, True),
    ],
)
def test_mean_force_tuned_to_its_limit(
    target: float, mean: float, within: bool, statistics: RunStatistics
) -> None:
    """Aimed at 169.328 N, the curve itself, 0.1 N beside it is inside; aimed beyond it is not."""
    check = tuned(target, mean, statistics)
    assert check.within is within
    assert ("tolerance of the tuning" in check.note) is (within and mean > check.limit)
    assert check.verdict == "unverified"


def at_speed(speed_kmh: float) -> Case:
    """Return the case with another speed."""
    return make_case().with_(**{"scenario.speed": speed_kmh / 3.6})


def test_no_limit_of_the_package_is_verified() -> None:
    """Nobody compared the file with the standards: every entry says so and names its standard."""
    content = load_limits()
    entries = (*content.limits, *content.tolerances)
    assert not any(entry.verified for entry in entries)
    assert all(entry.standard and entry.edition and entry.confidence for entry in entries)
    assert len({entry.id for entry in entries}) == len(entries)


def test_unverified_limits_never_pass(statistics: RunStatistics, case: Case) -> None:
    """`passed` is None and the verdict "unverified" for every check; `within` still tells."""
    rows = checks(statistics, case, free_uplift=0.2)
    assert len(rows) == 9
    assert all(row.passed is None and row.verdict == "unverified" for row in rows)
    assert all(row.within is not None for row in rows)


def test_values_and_limits_at_320_km_h(statistics: RunStatistics, case: Case) -> None:
    """sigma against 0.3 Fm, Fm between the AC curves, 350 N, 0.2 % and 0.7 c at 320 km/h."""
    part = statistics.pantograph().sharp
    rows = checks(statistics, case)
    [deviation] = by_name(rows, "standard deviation")
    assert deviation.value == part.standard_deviation
    assert deviation.limit == pytest.approx(0.3 * part.mean)
    [upper] = by_name(rows, "mean contact force, upper")
    assert upper.limit == pytest.approx(0.00097 * 320.0**2 + 70.0)
    [lower] = by_name(rows, "mean contact force, lower")
    assert lower.limit == pytest.approx(0.00047 * 320.0**2 + 60.0)
    assert (lower.sense, lower.within) == ("minimum", True)
    [largest] = by_name(rows, "largest contact force")
    assert (largest.value, largest.limit, largest.unit) == (part.maximum, 350.0, "N")
    [loss] = by_name(rows, "contact loss")
    assert (loss.value, loss.limit, loss.unit) == (0.0, 0.2, "%")
    [ratio] = by_name(rows, "speed over wave speed")
    assert ratio.value == pytest.approx(320.0 / 459.56, rel=1e-4)
    assert (ratio.within, ratio.pantograph) == (True, None)


@pytest.mark.parametrize(
    ("system", "speed_kmh", "upper", "largest", "loss"),
    [
        ("ac", 200.0, 108.8, 300.0, 0.1),
        ("ac", 250.0, 130.625, 350.0, 0.2),
        ("ac", 160.0, 102.032, 300.0, 0.1),
        ("dc-3kv", 200.0, 148.8, 300.0, 0.2),
        ("dc-1.5kv", 200.0, 178.8, 300.0, 0.2),
        ("DC-1.5kV", 220.0, 200.352, 400.0, 0.2),
    ],
)
def test_speed_class_and_system_choose_the_limit(
    statistics: RunStatistics, system: str, speed_kmh: float, upper: float, largest: float, loss
) -> None:
    """Every quantity has exactly one limit per system and speed class."""
    rows = checks(statistics, at_speed(speed_kmh), system=system)
    limits = [
        [row.limit for row in by_name(rows, name)]
        for name in ("mean contact force, upper", "largest contact force", "contact loss")
    ]
    assert limits == [[pytest.approx(upper)], [largest], [loss]]


@pytest.mark.parametrize("system", ["ac", "dc-1.5kv", "dc-3kv"])
def test_speed_classes_have_no_gap_and_no_overlap(statistics: RunStatistics, system: str) -> None:
    """From 80 to 360 km/h each check appears exactly once."""
    for speed_kmh in (80.0, 160.0, 160.1, 200.0, 200.1, 249.9, 250.0, 360.0):
        names = [row.name for row in checks(statistics, at_speed(speed_kmh), system=system)]
        assert len(names) == 8
        assert len(set(names)) == 8


def test_published_results_outside_a_limit_are_named(statistics: RunStatistics) -> None:
    """The benchmark's own 53.91 N exceed 0.3 times its 169 N: a run of AC simple that does too says
    so; a run of another line, and a value within, do not."""
    entry = statistics.pantographs[0]
    name = "standard deviation"

    def explained(case_name: str, sigma: float) -> str:
        filtered = {**entry.filtered, "sharp": replace(
            entry.sharp, mean=169.0, standard_deviation=sigma)}  # fmt: skip
        changed = replace(statistics, pantographs=(replace(entry, filtered=filtered),))
        case = make_case(name=case_name).with_(**{"scenario.speed": 320.0 / 3.6})
        return by_name(checks(changed, case), name)[0].explanation

    text = explained("ac-simple", 52.5)
    assert "mean of ten codes" in text
    assert "53.91 N against 50.7" in text
    assert not explained("ac-simple", 50.0)
    assert not explained("my-line", 52.5)


def test_uplift_needs_the_free_space(statistics: RunStatistics, case: Case) -> None:
    """Without the free space no uplift check; with it S0 <= space / 2, or / 1.5 with a stop."""
    assert not by_name(checks(statistics, case), "largest uplift")
    [free] = by_name(checks(statistics, case, free_uplift=0.12), "largest uplift")
    assert (free.value, free.limit) == (statistics.uplift.maximum, pytest.approx(0.06))
    rows = checks(statistics, case, free_uplift=0.12, uplift_stop=True)
    [stopped] = by_name(rows, "largest uplift")
    assert stopped.limit == pytest.approx(0.08)


def test_free_space_comes_from_the_option_the_requirement_or_the_stops(
    statistics: RunStatistics, case: Case
) -> None:
    """One order for all checks: what is asked for, then the requirement, then the smallest gap."""
    supports = case.supports.model_copy(update={"stop": UpliftStop(gap=0.08, stiffness=1e5)})
    stopped = case.model_copy(update={"supports": supports})
    wished = case.requirements.model_copy(update={"uplift_space": 0.12})
    both = stopped.model_copy(update={"requirements": wished})

    def limit(one: Case, free: float | None = None) -> float:
        [found] = by_name(checks(statistics, one, free_uplift=free), "largest uplift")
        return found.limit

    assert case.uplift_space() is None
    assert (stopped.uplift_space(), both.uplift_space()) == (0.08, 0.12)
    assert limit(stopped) == pytest.approx(0.08 / 1.5)
    assert limit(both) == pytest.approx(0.12 / 1.5)
    assert limit(both, 0.15) == pytest.approx(0.15 / 1.5)


def test_contact_loss_counts_arcs_of_5_ms(statistics: RunStatistics, case: Case) -> None:
    """Losses of 4 and 15 ms in 6 s give 0.25 %: the short one is no arc."""
    events = tuple(LossEvent(1.0, d, 300.0, "support 6", False) for d in (0.004, 0.015))
    entry = replace(statistics.pantograph(), contact_loss=ContactLoss("front", 6.0, events))
    [loss] = by_name(checks(replace(statistics, pantographs=(entry,)), case), "contact loss")
    assert loss.value == pytest.approx(0.25)
    assert loss.within is False
    assert loss.passed is None


def test_every_pantograph_is_checked() -> None:
    """With two pantographs force and loss checks appear for both."""
    case = make_case(pantographs=2)
    rows = checks(contact_statistics(make_run(case)), case)
    assert [row.pantograph for row in by_name(rows, "standard deviation")] == ["front", "rear"]


def test_verified_limit_passes_or_fails(
    statistics: RunStatistics, case: Case, tmp_path: Path
) -> None:
    """A limit that somebody verified decides: passed within, failed outside."""
    path = tmp_path / "mine.yaml"
    path.write_text(
        "schema: 1\nlimits:\n"
        + "".join(
            f"- {{id: a{value}, name: largest force, quantity: maximum, sense: maximum, unit: N, "
            f"limit: {{kind: constant, value: {value}}}, standard: EN 50119, edition: '2020', "
            "clause: '5.2', verified: true, verified_by: me, verified_on: '2026-01-31', "
            "confidence: read}\n"
            for value in (100.0, 1000.0)
        ),
        encoding="utf-8",
    )
    rows = checks(statistics, case, limits=load_limits(path))
    assert [row.passed for row in rows] == [False, True]
    assert [row.verdict for row in rows] == ["failed", "passed"]


def test_missing_value_is_neither_passed_nor_failed(case: Case) -> None:
    """Without a value the verdict is "no value", and JSON holds null."""
    empty = contact_statistics(make_run(status="partial", duration=1.0))
    rows = checks(empty, case)
    [deviation] = by_name(rows, "standard deviation")
    assert np.isnan(deviation.value)
    assert (deviation.within, deviation.verdict) == (None, "no value")
    data = json.loads(json.dumps([row.as_dict() for row in rows], allow_nan=False))
    assert data[0]["value"] is None
    assert {"name", "value", "limit", "unit", "standard", "verified", "passed"} <= set(data[0])


def test_unknown_system_is_refused(statistics: RunStatistics, case: Case) -> None:
    """An unknown supply system is refused with the known ones."""
    with pytest.raises(InputError, match=r"ac, dc-1.5kv, dc-3kv"):
        checks(statistics, case, system="25kv")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("limits: [", "line 1, column 10: while parsing"),
        ("schema: 2\nlimits: []", "schema"),
        ("schema: 1\nlimits: [{id: a}]", r"limits\[1\]"),
        ("schema: 1\nlimits: []\nlimit: 3", "limit: unknown key"),
        ("- 1", "must be a mapping of keys to values, not a list"),
    ],
)
def test_bad_file_of_limits_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """A malformed file is refused with its name, the place and the fault."""
    path = tmp_path / "limits.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        load_limits(path)


def test_unreadable_files_of_limits_are_refused(tmp_path: Path) -> None:
    """A folder, a missing file, binary data and a huge file are refused."""
    binary, huge = tmp_path / "binary.yaml", tmp_path / "huge.yaml"
    binary.write_bytes(b"\xff\xfe\x00")
    huge.write_bytes(b" " * 1_000_001)
    for path, message in (
        (tmp_path, "is a directory"),
        (tmp_path / "none.yaml", "there is no such file"),
        (binary, "UTF-8"),
        (huge, "at most 1 MB are read"),
    ):
        with pytest.raises(InputError, match=message):
            load_limits(path)


@pytest.mark.parametrize("value", ["!!bool maybe", "!!set {a}", "&a [*a]", "[" * 5000])
def test_hostile_files_of_limits_are_refused(value: str, tmp_path: Path) -> None:
    """Limits are read as cases are: plain YAML 1.2, no tags, no depth without end."""
    path = tmp_path / "limits.yaml"
    path.write_text(f"limits: {value}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"limits\.yaml"):
        load_limits(path)


def test_limits_are_immutable() -> None:
    """Limits cannot be changed after loading."""
    content = load_limits()
    with pytest.raises(ValueError, match="frozen"):
        content.limits[0].verified = True  # pyright: ignore[reportAttributeAccessIssue]
    assert isinstance(content, Limits)
