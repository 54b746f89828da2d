"""Tracks that cannot be are refused with place and cure; so are lines that do not fit to theirs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.errors import InputError, ModelError
from tautwire.inputs.load import load_case, make_case
from tautwire.model.build import build
from tautwire.model.passage import Passage, plan_passage
from tautwire.specs.case import Case

HEAD = "schema: 2\ninclude: ac-simple\nname: mine\n"

BAD_TRACKS = {
    "no kind": ("track: [{radius: 900 m}]", ["track.pieces[1]: has no kind", "with its length"]),
    "two kinds": (
        "track: [{straight: 400 m, arc: 600 m, radius: 900 m, side: left}]",
        ["track.pieces[1]: is straight and arc; write one of straight, transition and arc"],
    ),
    "negative radius": (
        "track: [{arc: 1000 m, radius: -900 m, side: left}]",
        ["track.pieces[1].radius: got -900 m; a radius is positive, and side tells left from"],
    ),
    "no radius, no side": (
        "track: [{arc: 1000 m}]",
        [
            "track.pieces[1].radius: is missing; an arc needs its radius",
            "track.pieces[1].side: is missing; say to which side the arc turns",
        ],
    ),
    "tiny radius": (
        "track: [{arc: 1000 m, radius: 5 m, side: left}]",
        ["track.pieces[1].radius: got 5 m; must be at least 20 m"],
    ),
    "negative cant": (
        "track: [{arc: 1000 m, radius: 900 m, side: left, cant: -90 mm}]",
        ["track.pieces[1].cant: got -90 mm; cant is the height of the outer rail: give its size"],
    ),
    "radius of a straight": (
        "track: [{straight: 1000 m, radius: 900 m}]",
        ["track.pieces[1].radius: belongs to an arc"],
    ),
    "cant of a straight": (
        "track: [{straight: 1000 m, cant: 20 mm}]",
        ["track.pieces[1].cant: belongs to an arc; transitions lead to it evenly"],
    ),
    "transition at the end": (
        "track: [{straight: 900 m}, {transition: 80 m}]",
        ["track.pieces[2].transition: needs a straight or an arc on either side", "add it"],
    ),
    "transition after transition": (
        "track: [{straight: 500 m}, {transition: 80 m}, {transition: 80 m}, {straight: 500 m}]",
        ["track.pieces[2].transition: needs", "track.pieces[3].transition: needs"],
    ),
    "jump of cant": (
        "track: [{straight: 500 m}, {arc: 500 m, radius: 900 m, side: left, cant: 90 mm}]",
        ["track.pieces[2].cant: jumps from 0 mm to 90 mm; put a transition between"],
    ),
    "list and table": (
        "track: {pieces: [{straight: 1000 m}], chainage: [0, 1000], radius: [0, 900]}",
        ["track.pieces: is given as well as the columns chainage, radius; keep one description"],
    ),
    "too short": (
        "track: [{straight: 500 m}]",
        ["track.pieces: reaches from 0 m to 500 m of the line, which is", "to support 18"],
    ),
    "rows too short": (
        "track: {chainage: [100, 2000], radius: [900, 900]}",
        ["track.chainage: reaches from 100 m to 2000 m of the line", "from support 1"],
    ),
    "radius too small for the spans": (
        "track: [{straight: 800 m}, {arc: 200 m, radius: 150 m, side: left}]",
        ["track.pieces[2]: the radius of 150 m is too small for span", "spans at most 43 m long"],
    ),
    "half circle": (
        "track: [{arc: 1000 m, radius: 300 m, side: right}]",
        ["track: turns by 191 degrees", "describe at most 150 degrees at once"],
    ),
    "columns of unlike length": (
        "track: {chainage: [0, 500, 1000], radius: [0, 900]}",
        ["track.radius: has 2 values for 3 rows; give one per row"],
    ),
    "columns without chainage": (
        "track: {radius: [0, 900]}",
        ["track.chainage: is missing; the other columns are given over it"],
    ),
    "falling chainage": (
        "track: {chainage: [0, 500, 400], radius: [0, 900, 900]}",
        ["track.chainage[3]: got 400 m after 500 m; must increase"],
    ),
    "cant against the curve": (
        "track: {chainage: [0, 1000], radius: [-900, -900], cant: [90 mm, 90 mm]}",
        ["track.cant[1]: got 90 mm in a curve of -900 m, which raises the inner rail", "sign"],
    ),
    "steep rows": (
        "track: {chainage: [0, 100, 1000], height: [0, 20, 20]}",
        ["track.height[2]: rises by 20 m over 100 m; at most 150 per mille are possible"],
    ),
    "one point": (
        "track: {profile: [{at: 0, height: 3}]}",
        ["track.profile: has one point; a gradient needs two"],
    ),
    "sharp profile": (
        "track: {profile: [{at: 0, height: 0}, {at: 500, height: 5}, {at: 1000, height: 5}]}",
        ["track.profile[2].radius: is missing; the gradient changes by -10.00 per mille here"],
    ),
    "roundings that meet": (
        "track: {profile: [{at: 0, height: 0}, {at: 500, height: 5, radius: 200 km}, "
        "{at: 1000, height: 5}]}",
        ["track.profile[2].radius: gives a vertical curve of 2000.0 m, which runs into"],
    ),
    "points out of order": (
        "track: {profile: [{at: 500, height: 0}, {at: 0, height: 5}]}",
        ["track.profile[2].at: got 0 m after 500 m; must increase"],
    ),
    "word for a track": (
        "supports: {superelevation: 90 mm}",
        ["supports.superelevation: unknown key; it is given as track.cant"],
    ),
}


@pytest.mark.parametrize("fault", BAD_TRACKS)
def test_bad_track(fault: str, tmp_path: Path) -> None:
    """The message names the place in the file and what to do."""
    text, words = BAD_TRACKS[fault]
    path = tmp_path / "mine.yaml"
    path.write_text(HEAD + text + "\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert [word for word in words if word not in str(caught.value)] == []


def test_table_of_the_track(tmp_path: Path) -> None:
    """Columns come from a CSV file; a wrong cell is named by file, line and column."""
    table = tmp_path / "track.csv"
    table.write_text("chainage,radius,cant [mm]\n0,0,0\n400,0,0\n480,1200,90\n935,1200,90\n")
    path = tmp_path / "mine.yaml"
    path.write_text(HEAD + "track: {table: track.csv}\n", encoding="utf-8")
    assert load_case(path).track.cant == (0.0, 0.0, 0.09, 0.09)
    table.write_text("chainage,radius,cant [mm]\n0,0,0\n400,0,0\n480,-1200,90\n935,1200,90\n")
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert "track.cant[3]" in str(caught.value)
    assert "4, column 'cant [mm]'): got 90 mm in a curve of -1200 m" in str(caught.value)


ARC = {"track": [{"arc": 220.0, "radius": 2400.0, "side": "left"}], "line": {"spans": 4}}


def test_support_without_lateral_force_is_named() -> None:
    """Stagger that cancels the curve's pull leaves an arm with nothing to hold: b = L^2/2R."""
    stagger = [0.0, 0.0, 55.0**2 / 2.0 / 2400.0, 0.0, 0.0]
    case = make_case(
        {
            "include": "ac-simple",
            **ARC,
            "supports": {"closure": "height", "contact_stagger": stagger},
            "settings": {"section": [2, 3]},
        }
    )
    bare = case.with_(**{"supports.contact_stagger": tuple(-v for v in stagger)})
    find_shape(build(bare))
    with pytest.raises(ModelError, match=r"steady arm at support 3, x = 110.00 m, pulls sideways"):
        find_shape(build(case))


def test_wire_that_leaves_the_head_sideways_is_told() -> None:
    """In a curve with the stagger on the wrong side the wire runs off the head between supports."""
    case = make_case(
        {
            "include": "ac-simple",
            "track": [{"arc": 220.0, "radius": 600.0, "side": "left"}],
            "line": {"spans": 4},
            "supports": {"closure": "height", "contact_stagger": [0.3] * 5},
            "settings": {"section": [2, 3]},
        }
    )
    model = build(case)
    shape = find_shape(model)
    with pytest.raises(
        ModelError, match=r"leaves the head of pantograph 'front' sideways: in span"
    ):
        plan_passage(model, shape, case.uplift_forces())


def _aside(left: float, right: float, section: list[int]) -> tuple[Case, Passage]:
    """Return seven spans with the staggers at their ends [m], and what is planned over them."""
    stagger = [left, 0.3, -0.2, 0.2, -0.2, 0.2, -0.3, right]
    case = make_case(
        {
            "include": "ac-simple",
            "line": {"spans": 7},
            "supports": {"contact_stagger": stagger},
            "settings": {"section": section, "nodes_between_droppers": 4, "graded_mesh": False},
        }
    )
    model = build(case)
    return case, plan_passage(model, find_shape(model), case.uplift_forces())


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("right", [0.95, 0.2])
def test_passage_begins_and_ends_where_the_wire_lies_on_the_head(
    right: float, direction: str
) -> None:
    """Where only an end runs off the head, the passage keeps from that end, which is told."""
    case, passage = _aside(0.95, right, [3, 5])
    start, length = case.settings.start, case.line.length()
    (told,) = passage.warnings
    kept = re.search(r"keeps (\S+) m from the left end and (\S+) m from the right one$", told)
    assert kept is not None
    ends = [float(way) for way in kept.groups()]
    assert 10.0 < ends[0] < 30.0
    assert ends[1] == start if right == 0.2 else 5.0 < ends[1] < ends[0]  # steeper on the right
    assert passage.duration == pytest.approx((length - sum(ends)) / case.scenario.speed)
    assert passage.pantographs[0].start_x == ends[0]
    case = case.with_(**{"scenario.direction": direction})
    model = build(case)
    passage = plan_passage(model, find_shape(model), case.uplift_forces())
    entry = ends[0] if direction == "+x" else length - ends[1]
    assert passage.pantographs[0].start_x == entry
    way = case.scenario.speed * passage.latest
    assert way == pytest.approx(length - abs(entry - (0.0 if direction == "+x" else length)) - 0.1)


def test_late_start_tells_that_the_force_still_grows() -> None:
    """Where a late start leaves too little way before the section, that is told as in 'check'."""
    case, passage = _aside(0.95, 0.95, [2, 6])
    way = 55.0 - passage.pantographs[0].start_x
    ramp = case.settings.ramp * case.scenario.speed
    assert way < ramp
    assert passage.warnings[1].startswith(
        f"the analysed section begins {way:.0f} m after this start, and the uplift force grows "
        f"over {ramp:.0f} m"
    )
