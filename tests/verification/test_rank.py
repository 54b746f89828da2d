"""Ranked corrections: parts of lines, local against full passages, going on after a stop."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.as_built import with_values
from tautwire.analyses.survey.corrections import Correction
from tautwire.analyses.survey.local import SHORT, felt_at, place_of, simulated
from tautwire.analyses.survey.part import part_of_line
from tautwire.analyses.survey.rank import rank, rank_lines
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.errors import InputError
from tautwire.model.build import build
from tautwire.specs.case import Case

from ..lines import AC_SIMPLE

MESH = {"nodes_between_droppers": None, "band": 40.0, "graded_mesh": False}


def design(spans: int = 5, **changes: Any) -> Case:
    """Return a line at 160 km/h on a mesh for 40 Hz."""
    settings = {**AC_SIMPLE["settings"], **MESH, "section": [2, spans - 1]}
    data = {**AC_SIMPLE, "line": {"spans": spans, "span_length": 55.0}, "settings": settings}
    data["scenario"] = {"speed": 160.0 / 3.6, "uplift_force": 110.0}
    return Case.model_validate({**data, **changes})


def wrong(case: Case, changes: dict[int, float]) -> Case:
    """Return a case with some unknowns changed."""
    line = SurveyedLine(build(case))
    values = line.design.values.copy()
    for row, change in changes.items():
        values[row] += change
    return with_values(case, line, values)


CURVE = [
    {"straight": 90.0},
    {"transition": 60.0},
    {"arc": 400.0, "radius": 900.0, "side": "left", "cant": 0.08},
]


@pytest.mark.parametrize("track", [[], CURVE], ids=["straight", "curve"])
def test_a_part_hangs_like_the_line_that_it_is_cut_from(track: list[dict[str, Any]]) -> None:
    """Dropper forces and heights over the rails of spans 3 to 5 are those of the whole line, one
    with errors of lengths and heights, but for the outer spans, whose neighbours are missing."""
    random = np.random.default_rng(8)
    supports = {**AC_SIMPLE["supports"], "contact_stagger": [0.2, -0.2] * 3 + [0.2]}
    case = design(6, track=track, supports=supports)
    count = SurveyedLine(build(case)).count
    case = wrong(case, dict(enumerate(random.normal(0.0, 0.003, count).tolist())))
    whole, part = (find_design(build(one)) for one in (case, part_of_line(case, 2, 6)))
    per_span = len(whole.dropper_x) // 6
    inner = slice(2 * per_span, 5 * per_span)
    own = slice(per_span, 4 * per_span)
    assert np.allclose(part.dropper_x[own] + 55.0, whole.dropper_x[inner], atol=1e-6)
    assert np.abs(part.dropper_heights[own] - whole.dropper_heights[inner]).max() < 5e-5
    assert np.abs(part.dropper_forces[own] - whole.dropper_forces[inner]).max() < 0.2


def test_a_correction_is_felt_as_a_full_passage_says() -> None:
    """The change of the force by a dropper of 20 mm, from a passage over a part of a line of nine
    spans, is that of passages over the whole line within 25 % of its root mean square, and its
    size within 10 %."""
    case = design(9)
    line = SurveyedLine(build(case))
    row = next(n for n, h in enumerate(line.model.line.hangers)
               if (h.label.span, h.label.number) == (5, 4))  # fmt: skip
    built = wrong(case, {row: 0.02})
    values = line.design.values.copy()
    values[row] += 0.02
    one = Correction(row, "dropper", 5, 4, line.model.line.hangers[row].lower.s,
                     float(values[row]), float(line.design.values[row]))  # fmt: skip
    place = place_of(line, built, values, 5, [one], SHORT)
    assert place.built.line.spans == 7
    ((felt,), _) = felt_at(place)
    before, after = simulated(built), simulated(case)
    change = after.filtered - before.filtered
    full = np.interp(felt.position, before.position, change)
    missed = np.sqrt(np.mean((felt.filtered - full) ** 2) / np.mean(full**2))
    assert missed < 0.25
    assert abs(np.std(felt.filtered) / np.std(full) - 1.0) < 0.1


def test_corrections_are_felt_on_the_other_side_when_running_back() -> None:
    """Towards falling positions the two spans behind a correction are those left of it."""
    forward = design(9)
    back = forward.with_(**{"scenario.direction": "-x"})
    line = SurveyedLine(build(forward))
    one = Correction(40, "dropper", 5, 4, 240.0, 1.0, 1.01)
    places = [place_of(line, case, line.design.values, 5, [one], SHORT) for case in (forward, back)]
    assert [place.felt for place in places] == [(165.0, 385.0), (110.0, 330.0)]
    assert [place.start for place in places] == [55.0, 55.0]


def test_the_culprit_comes_first_and_the_gain_is_that_of_a_full_passage(tmp_path: Path) -> None:
    """A dropper 20 mm too short comes before one of 4 mm two spans on; what both gain together is
    that of the corrected line within 0.1 N; a ranking goes on from the passages that are kept."""
    case = design()
    built = wrong(case, {13: -0.020, 31: 0.004})
    ranking = rank(case, built, keep=tmp_path / "passages")
    first, second = ranking.ranked
    assert (first.correction.span, first.correction.number) == (2, 5)
    assert abs(first.correction.change - 0.020) < 1e-4
    assert (second.correction.span, second.correction.number) == (4, 5)
    assert first.effect > 3.0 * second.effect
    missed = second.together.standard_deviation - ranking.checked.standard_deviation
    assert abs(missed) < 0.1
    assert ranking.cpu > 0.0
    again = rank(case, built, keep=tmp_path / "passages")
    assert again.cpu == 0.0
    assert again.ranked == ranking.ranked


@pytest.mark.slow
def test_the_gain_of_a_support_is_that_of_a_full_passage() -> None:
    """What a messenger support of 30 mm gains on a line of eleven spans with scatter of 3 mm is
    predicted within 0.1 N; passages over the few spans that the order needs miss it by 0.35 N."""
    case, random = design(11), np.random.default_rng(2)
    line = SurveyedLine(build(case))
    changes = dict(enumerate(random.normal(0.0, 0.003, line.count).tolist()))
    changes[line.droppers + line.messenger.index(6)] = 0.03
    ranking = rank(case, wrong(case, changes), least=0.02)
    (one,) = ranking.ranked
    assert (one.correction.kind, one.correction.number) == ("messenger height", 6)
    gain = ranking.built.standard_deviation - ranking.checked.standard_deviation
    assert gain > 0.3
    assert abs(one.together.standard_deviation - ranking.checked.standard_deviation) < 0.1


def test_lines_ranked_together_are_those_ranked_alone(tmp_path: Path) -> None:
    """One list over two tension lengths has the effects of either by itself, in one order."""
    case = design(3)
    pairs = [(case, wrong(case, changes)) for changes in ({13: -0.01, 3: 0.006}, {12: 0.02})]
    together = rank_lines(pairs, keep=tmp_path)
    for one, pair in zip(together, pairs, strict=True):
        alone = rank(*pair, keep=tmp_path)
        assert [(a.correction, a.effect, a.together) for a in one.ranked] == [
            (a.correction, a.effect, a.together) for a in alone.ranked
        ]
        assert one.checked == alone.checked
    places = {one.place: one.effect for ranking in together for one in ranking.ranked}
    assert sorted(places) == [1, 2, 3]
    assert places[1] > places[2] > places[3]
    assert together[1].ranked[0].place == 1


class _StoppedError(Exception):
    pass


def test_a_stop_loses_nothing_that_is_finished(tmp_path: Path) -> None:
    """After a stop at the second of two places the first is kept; two processes that go on give
    the same list as one that computes everything."""
    case = design(3)
    built = wrong(case, {3: -0.004, 13: -0.020})

    def stop(done: int, _count: int) -> None:
        if done == 1:
            raise _StoppedError

    with pytest.raises(_StoppedError):
        rank(case, built, keep=tmp_path, watch=stop)
    kept = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*.npz")}
    assert len(kept) == 1
    ranking = rank(case, built, keep=tmp_path, workers=2)
    assert all((tmp_path / name).stat().st_mtime_ns == when for name, when in kept.items())
    assert rank(case, built).ranked == ranking.ranked


def test_what_cannot_be_ranked_is_refused() -> None:
    """A line as designed has nothing to correct; another line is not the same one as built."""
    case = design(3)
    with pytest.raises(InputError, match="nothing deviates"):
        rank(case, wrong(case, {3: 0.001}))
    with pytest.raises(InputError, match="other spans or dropper places"):
        rank(case, design(4))


@pytest.mark.slow
def test_a_planted_culprit_is_among_the_first_three() -> None:
    """Among scatter of 3 mm a dropper of 20 mm, a slack one and a support of 30 mm are found, and
    the first ten gain what a full passage says within 15 % or 0.3 N."""
    random, case = np.random.default_rng(3), design(6)
    line = SurveyedLine(build(case))
    culprits = {22: -0.020, 30: 0.040, line.droppers + 2: 0.030}
    for row, change in culprits.items():
        scatter = dict(enumerate(random.normal(0.0, 0.003, line.count).tolist()))
        ranking = rank(case, wrong(case, {**scatter, row: change}))
        assert row in [one.correction.row for one in ranking.ranked[:3]]
        last = ranking.ranked[min(10, len(ranking.ranked)) - 1].together
        gain = ranking.built.standard_deviation - ranking.checked.standard_deviation
        missed = last.standard_deviation - ranking.checked.standard_deviation
        assert abs(missed) < max(0.3, 0.15 * gain)
