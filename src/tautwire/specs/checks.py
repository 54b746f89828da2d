"""Checks between the parts of a case; each returns every problem it finds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from tautwire.specs.base import Problem
from tautwire.specs.conditions.checks import (
    check_conditions,
    check_places,
    check_slowed_waves,
)
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.dropper import Droppers, check_sets
from tautwire.specs.line.fitting import check_fittings
from tautwire.specs.line.irregularity import check_irregularities
from tautwire.specs.line.support import Supports, check_cantilevers, check_hinges
from tautwire.specs.line.tension import check_tension_lengths
from tautwire.specs.line.track import check_track
from tautwire.specs.line.wire import Wires
from tautwire.specs.pantograph import Pantograph
from tautwire.specs.requirements import check_gauge, check_requirements
from tautwire.specs.scenario import Scenario
from tautwire.specs.settings import Settings

MIN_SPACING = 0.05
"""Smallest distance [m] between neighbouring attachment points: two clamps side by side."""


def check_support_lists(line: Line, supports: Supports) -> list[Problem]:
    """Check that lists per support have one value for every support of the line."""
    count = line.spans + 1
    names = (
        "contact_height",
        "encumbrance",
        "contact_stagger",
        "messenger_stagger",
        "hinge",
        "arm_end_y",
        "arm_end_z",
        "type",
    )
    problems = [
        Problem(
            ("supports", name),
            f"has {len(values)} values; {line.spans} spans have {count} supports, both anchors "
            "included: give one value per support",
        )
        for name in names
        if isinstance(values := getattr(supports, name), tuple) and len(values) != count
    ]
    return problems + _missing_arm_ends(line, supports) + check_hinges(line, supports)


def _missing_arm_ends(line: Line, supports: Supports) -> list[Problem]:
    if supports.closure != "arm":
        return []
    problems = []
    for name in ("arm_end_y", "arm_end_z"):
        values = getattr(supports, name)
        if values is None or len(values) != line.spans + 1:
            continue
        problems += [
            Problem(("supports", name, index), "is missing; only the two anchors carry no arm")
            for index in range(1, line.spans)
            if values[index] is None
        ]
    return problems


DropperSets = Droppers | tuple[Droppers, ...]


def _sets(droppers: DropperSets) -> list[tuple[tuple[str | int, ...], Droppers]]:
    """Return paths and sets of droppers, as they are written."""
    if isinstance(droppers, tuple):
        return [(("droppers", index), one) for index, one in enumerate(droppers)]
    return [(("droppers",), droppers)]


def check_dropper_wires(wires: Wires, supports: Supports, droppers: DropperSets) -> list[Problem]:
    """Check that sets of droppers name wires of the line and that every wire hangs on something."""
    names = dict(wires.named())
    problems = []
    for path, one in _sets(droppers):
        for field, name in (("from", one.upper), ("to", one.lower)):
            if name not in names:
                text = f"got {name!r}; there are the wires {', '.join(names)}"
                problems.append(Problem((*path, field), text))
        if one.upper in names and names[one.upper].role == "contact":
            problems.append(Problem((*path, "from"), f"{one.upper!r} is a contact wire"))
        if one.upper == one.lower:
            problems.append(Problem((*path, "to"), "is the wire above too"))
    carried = {one.lower for _, one in _sets(droppers)}
    if wires.messenger is not None:
        if supports.encumbrance is None:
            text = "is missing; the height of the messenger wire above the contact wire is needed"
            problems.append(Problem(("supports", "encumbrance"), text))
        problems += [
            Problem(("droppers",), f"no set of droppers carries the wire {name!r}; add one to it")
            for name, wire in names.items()
            if wire.role in ("contact", "auxiliary") and name not in carried
        ]
    return problems


def check_encumbrance(
    line: Line, wires: Wires, supports: Supports, droppers: DropperSets
) -> list[Problem]:
    """Check that the messenger wire hangs above the contact wire; name the worst dropper alone."""
    if isinstance(droppers, tuple) or droppers.mode != "height" or wires.messenger is None:
        return []
    if droppers.about == "mast" or droppers.lower != "contact":
        return []
    encumbrances = supports.encumbrances(line.spans + 1)
    rows = droppers.positions_by_span(line.spans), droppers.presag_by_span(line.spans)
    if len(encumbrances) != line.spans + 1 or {len(table) for table in rows} != {line.spans}:
        return []
    found = [
        (estimated, span, index)
        for span in range(line.spans)
        for index, estimated in enumerate(
            dropper_lengths(line, wires, droppers, encumbrances[span : span + 2], span)
        )
    ]
    length, span, index = min(found, default=(1.0, 0, 0))
    if length > 0.0:
        return []
    least = math.ceil(100.0 * (max(encumbrances[span : span + 2]) - length + 0.05)) / 100.0
    return [
        Problem(
            ("supports", "encumbrance"),
            f"is too small: at dropper {index + 1} of span {span + 1} the messenger wire would "
            f"hang {-1e3 * length:.0f} mm below the contact wire, because its sag grows with the "
            f"weight and the square of the span over its tension; give at least {least:.2f} m, or "
            "raise wires.messenger.tension",
        )
    ]


def dropper_lengths(
    line: Line, wires: Wires, droppers: Droppers, encumbrances: Sequence[float], span: int
) -> list[float]:
    """Estimate the lengths of the droppers of a span [m] in mode 'height'.

    The sags of both wires times their tensions carry the weight of the span,
    ``T_m s_m(x) + T_c s_c(x) = w x (L - x)/2`` (moments about a cut; bending, the inclination of
    the arms and the mass of the droppers neglected: 3 to 13 mm too short), and a dropper at x has
    the length ``encumbrance + s_c - s_m``.

    Parameters
    ----------
    line, wires, droppers
    encumbrances
        At the left and at the right support [m].
    span
        Counted from 0.
    """
    messenger = wires.messenger or wires.contact
    length, (left, right) = line.span_lengths()[span], encumbrances
    positions = droppers.positions_by_span(line.spans)[span]
    clamps = len(positions) * (droppers.clamp_contact + droppers.clamp_messenger)
    weight = (wires.contact.mass + messenger.mass + clamps / length) * line.gravity
    return [
        left + (right - left) * x / length + sag
        - (0.5 * weight * x * (length - x) - wires.contact.tension * sag) / messenger.tension
        for x, sag in zip(positions, droppers.presag_by_span(line.spans)[span], strict=False)
    ]  # fmt: skip


def check_droppers(line: Line, droppers: DropperSets) -> list[Problem]:
    """Check that droppers lie inside their span, in order, each with its value."""
    problems = []
    for path, one in _sets(droppers):
        if one.about == "span":
            found = _check_set(line, one)
            problems += [Problem((*path, *problem.path[1:]), problem.text) for problem in found]
        else:
            problems += _check_about_masts(line, one, path)
    return problems


def _check_about_masts(line: Line, one: Droppers, path: tuple[str | int, ...]) -> list[Problem]:
    masts = line.spans - 1
    rows = one.positions_by_span(masts)
    values = "presag" if one.mode == "height" else "lengths"
    given = one.presag_by_span(masts) if values == "presag" else one.lengths_by_span(masts)
    if len(rows) != masts or len(given) != masts:
        text = f"has {len(rows)} lists for {masts} supports between the anchors"
        return [Problem((*path, "positions"), f"{text}; give one list, or one per support")]
    for row, items in zip(rows, given, strict=True):
        if len(row) != len(items):
            text = f"has {len(items)} values for {len(row)} droppers; give one value per dropper"
            return [Problem((*path, values), text)]
        if any(right < left + MIN_SPACING for left, right in pairwise(row)):
            text = f"must rise by at least {MIN_SPACING:g} m from dropper to dropper"
            return [Problem((*path, "positions"), text)]
    return []


def _check_set(line: Line, droppers: Droppers) -> list[Problem]:
    """Check one set that counts from the supports on the left of the spans."""
    counts = [
        Problem(
            ("droppers", name),
            f"has {len(rows)} lists for {line.spans} spans; give one list per span, or one list "
            "for all spans",
        )
        for name, rows in _lists_in_use(line, droppers).items()
        if len(rows) != line.spans
    ]
    if counts:
        return counts
    problems = []
    for span in _distinct_spans(line, droppers):
        problems += _check_positions(line, droppers, span)
        problems += _check_values(line, droppers, span)
    return problems


def _lists_in_use(line: Line, droppers: Droppers) -> dict[str, tuple[tuple[float, ...], ...]]:
    lists = {"positions": droppers.positions_by_span(line.spans)}
    if droppers.mode == "height":
        lists["presag"] = droppers.presag_by_span(line.spans)
    else:
        lists["lengths"] = droppers.lengths_by_span(line.spans)
    return lists


def _is_table(values: object) -> bool:
    return isinstance(values, tuple) and bool(values) and isinstance(values[0], tuple)


def _value_path(droppers: Droppers, name: str, span: int, *index: int) -> tuple[str | int, ...]:
    """Return the path as the user wrote the list: for every span, or span by span."""
    if _is_table(getattr(droppers, name)):
        return ("droppers", name, span, *index)
    return ("droppers", name, *index)


def _distinct_spans(line: Line, droppers: Droppers) -> Sequence[int]:
    """Return the spans to check: where nothing differs between spans, the first is enough."""
    names = _lists_in_use(line, droppers)
    if isinstance(line.span_length, tuple) or any(_is_table(getattr(droppers, n)) for n in names):
        return range(line.spans)
    return (0,)


def _check_positions(line: Line, droppers: Droppers, span: int) -> list[Problem]:
    length = line.span_lengths()[span]
    positions = droppers.positions_by_span(line.spans)[span]
    problems = []
    previous = 0.0
    for index, position in enumerate(positions):
        path = _value_path(droppers, "positions", span, index)
        if position > length - MIN_SPACING:
            problems.append(
                Problem(
                    path,
                    f"got {position:g} m, outside the span of {length:g} m; droppers hang between "
                    f"{MIN_SPACING:g} m and {length - MIN_SPACING:g} m from its left support",
                )
            )
        elif position < previous + MIN_SPACING:
            neighbour = "the support" if index == 0 else f"dropper {index} at {previous:g} m"
            problems.append(
                Problem(
                    path,
                    f"got {position:g} m, less than {MIN_SPACING:g} m beyond {neighbour}; list "
                    "the positions from left to right",
                )
            )
        previous = position
    return problems


def _check_values(line: Line, droppers: Droppers, span: int) -> list[Problem]:
    positions = droppers.positions_by_span(line.spans)[span]
    problems = []
    for name, rows in _lists_in_use(line, droppers).items():
        if len(rows[span]) != len(positions):
            problems.append(
                Problem(
                    _value_path(droppers, name, span),
                    f"has {len(rows[span])} values for {len(positions)} droppers "
                    f"(droppers.positions of span {span + 1}); give one value per dropper",
                )
            )
    return problems


def check_speed(wires: Wires, scenario: Scenario) -> list[Problem]:
    """Check that the train is slower than the waves on the contact wire."""
    wave_speed = wires.contact.wave_speed()
    if scenario.speed < wave_speed:
        return []
    return [
        Problem(
            ("scenario", "speed"),
            f"got {scenario.speed * 3.6:.1f} km/h, not below the wave speed of the contact wire, "
            f"sqrt(tension/mass) = {wave_speed * 3.6:.1f} km/h; lower the speed or raise "
            "wires.contact.tension",
        )
    ]


def check_pantograph_row(pantographs: Sequence[Pantograph]) -> list[Problem]:
    """Check names and distances of the pantographs of a train."""
    problems = []
    names = [pantograph.name for pantograph in pantographs]
    for index, pantograph in enumerate(pantographs):
        if pantograph.name in names[:index]:
            problems.append(
                Problem(
                    ("pantographs", index, "name"),
                    f"got {pantograph.name!r} again; give every pantograph its own name",
                )
            )
        if index == 0 and pantograph.behind != 0.0:
            problems.append(
                Problem(
                    ("pantographs", 0, "behind"),
                    f"got {pantograph.behind:g} m; the first pantograph leads, its distance is 0",
                )
            )
        if index > 0 and pantograph.behind <= pantographs[index - 1].behind:
            problems.append(
                Problem(
                    ("pantographs", index, "behind"),
                    f"got {pantograph.behind:g} m, not behind pantograph {index} at "
                    f"{pantographs[index - 1].behind:g} m; list the pantographs from the front, "
                    "each with its distance behind the first",
                )
            )
    return problems


def check_forces(scenario: Scenario, pantographs: Sequence[Pantograph]) -> list[Problem]:
    """Check that every pantograph has one uplift force."""
    problems = []
    for name in ("uplift_force", "uplift_guess"):
        values = getattr(scenario, name)
        if isinstance(values, tuple) and len(values) != len(pantographs):
            problems.append(
                Problem(
                    ("scenario", name),
                    f"has {len(values)} values for {len(pantographs)} pantographs; give one "
                    "value each, or a single value for all",
                )
            )
    if scenario.mean_force is None and scenario.uplift_force is None:
        problems += [
            Problem(
                ("pantographs", index, "static_force"),
                f"the uplift force is {pantograph.uplift_force(scenario.air):g} N; give "
                "static_force (for example '70 N'), scenario.mean_force or scenario.uplift_force",
            )
            for index, pantograph in enumerate(pantographs)
            if pantograph.uplift_force(scenario.air) <= 0.0
        ]
    target = scenario.target_mean_force()
    if target is not None and target <= 0.0:
        problems.append(
            Problem(
                ("scenario", "mean_force"),
                f"gives {target:g} N at {scenario.speed * 3.6:.1f} km/h; the mean force must be "
                "positive",
            )
        )
    return problems


def check_section(line: Line, settings: Settings) -> list[Problem]:
    """Check that the analysed section lies on the line."""
    problems = []
    if settings.section is not None and settings.section[1] > line.spans:
        first, last = settings.section
        problems.append(
            Problem(
                ("settings", "section"),
                f"got [{first}, {last}]; the line has {line.spans} spans: choose a section "
                "inside, or leave it out for the default",
            )
        )
    return problems


def check_start(line: Line, settings: Settings) -> list[Problem]:
    """Check that the way of a passage meets the analysed section.

    The way leaves out ``settings.start`` at both ends of the line, in either direction.
    """
    length, start = line.length(), settings.start
    first, last = settings.resolved_section(line.spans)
    if last > line.spans:
        return []
    supports = line.support_positions()
    cure = "start nearer to the anchor (typical: 5 m)"
    if 2.0 * start >= length:
        what = f"the line is {length:g} m long and a passage leaves out as much at its other end"
        return [Problem(("settings", "start"), f"got {start:g} m; {what}: {cure}")]
    if supports[last] <= start or supports[first - 1] >= length - start:
        what = (
            f"a passage from {start:g} m to {length - start:g} m never meets the analysed section "
            f"(spans {first} to {last}); {cure}, or choose another settings.section"
        )
        return [Problem(("settings", "start"), f"got {start:g} m; {what}")]
    return []


def check_train_length(
    line: Line, pantographs: Sequence[Pantograph], settings: Settings
) -> list[Problem]:
    """Check that every trailing pantograph reaches the line."""
    room = line.length() - settings.start
    return [
        Problem(
            ("pantographs", index, "behind"),
            f"got {pantograph.behind:g} m; the leading pantograph runs {room:g} m on the line, so "
            "this one never reaches it: lengthen the line (line.spans)",
        )
        for index, pantograph in enumerate(pantographs)
        if pantograph.behind >= room
    ]


Check = Callable[..., list[Problem]]
CHECKS: tuple[tuple[tuple[str, ...], Check], ...] = (
    (("line", "supports"), check_support_lists),
    (("line", "track", "pantographs"), check_track),
    (("line", "droppers"), check_droppers),
    (("line", "tension_lengths", "overlaps"), check_tension_lengths),
    (("line", "wires", "droppers", "tension_lengths"), check_sets),
    (("wires", "supports", "droppers"), check_dropper_wires),
    (("line", "wires", "supports", "droppers"), check_encumbrance),
    (("wires", "supports"), check_cantilevers),
    (("wires", "scenario"), check_speed),
    (("pantographs",), check_pantograph_row),
    (("scenario", "pantographs"), check_forces),
    (("line", "settings"), check_section),
    (("line", "settings"), check_start),
    (("line", "pantographs", "settings"), check_train_length),
    (("line", "droppers", "irregularities"), check_irregularities),
    (("conditions", "condition", "wires", "droppers"), check_conditions),
    (("line", "tension_lengths", "conditions"), check_places),
    (("conditions", "wires", "scenario"), check_slowed_waves),
    (("line", "wires", "tension_lengths", "bodies", "stays"), check_fittings),
    (("line", "requirements"), check_requirements),
    (("requirements", "conditions", "wires", "droppers"), check_gauge),
)
"""Every check with the parts of the case it needs, so that it can run when others are invalid."""


def find_contradictions(parts: Mapping[str, Any]) -> list[Problem]:
    """Run every check whose parts are all at hand.

    Parameters
    ----------
    parts
        Valid parts of a case by field name; parts that are not valid are left out.
    """
    problems = []
    for needs, check in CHECKS:
        if all(name in parts for name in needs):
            problems += check(*(parts[name] for name in needs))
    return problems
