"""Studies written out into cases: values, combinations, refusals, keys."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.catalogue.entries import copy_case
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.studies.plan import Plan, key_of, pending, plan_study
from tautwire.studies.study_file import load_study, make_study


def plan(axes: dict[str, Any], **more: Any) -> Plan:
    """Write out a study of the reference line."""
    data = {"schema": 1, "name": "test", "base": "ac-simple", "axes": axes, **more}
    return plan_study(make_study(data))


def refusal(axes: dict[str, Any], **more: Any) -> str:
    """Return the sentences with which a study is refused."""
    with pytest.raises(InputError) as caught:
        plan(axes, **more)
    return "\n".join(caught.value.problems)


def test_grid_is_every_combination() -> None:
    """A grid has the product of its axes, the last one fastest, each a valid case."""
    made = plan({"scenario.speed": ["200 km/h", 80], "settings.seed": {"seeds": 3, "first": 7}})
    assert made.shape == (2, 3)
    assert [point.number for point in made.points] == [1, 2, 3, 4, 5, 6]
    assert made.coordinates(made.points[4]) == {"speed": 80.0, "seed": 8}
    case = made.case(made.points[4])
    assert (case.scenario.speed, case.settings.seed) == (80.0, 8)


DEFECTS = (
    ({"kind": "missing dropper", "span": 8}, "dropper", [1, 9]),
    ({"kind": "slack dropper", "dropper": 2}, "span", [2, 9]),
    ({"kind": "dropper length", "span": 8, "dropper": 3}, "change", ["-10 mm", "10 mm"]),
    ({"kind": "swapped droppers", "span": 8, "dropper": 1}, "with", [2, 5]),
    ({"kind": "broken steady arm"}, "support", [5, 9]),
    ({"kind": "displaced support", "support": 7}, "lateral", ["-30 mm", "30 mm"]),
    ({"kind": "displaced support", "support": 7}, "vertical", ["-30 mm", "30 mm"]),
    ({"kind": "extra mass", "span": 8, "wire": "contact", "at": "10 m"}, "mass", [0.5, 3.0]),
    ({"kind": "extra mass", "span": 8, "wire": "contact", "mass": "3 kg"}, "at", ["5 m", "20 m"]),
    ({"kind": "seized tensioning device", "wire": "contact"}, "end", ["left", "right"]),
    ({"kind": "broken stitch wire"}, "support", [5, 9]),
)
"""Defects without one of their values, its key, and values for it."""


@pytest.mark.parametrize(("defect", "key", "values"), DEFECTS, ids=lambda v: str(v)[:30])
def test_every_defect_is_an_axis(
    defect: dict[str, Any], key: str, values: list[Any], tmp_path: Path
) -> None:
    """Every value of a defect can be varied: one case per value, each of which can be built."""
    condition = {"name": "worn out", "defects": [defect | {key: values[0]}]}
    case = tmp_path / "line.yaml"
    base = "ac-stitched" if "stitch" in defect["kind"] else "ac-simple"
    text: dict[str, Any] = {"include": base, "name": "line", "conditions": [condition]}
    text["line"] = {"ends": "weighted"}
    case.write_text(json.dumps(text), encoding="utf-8")
    axes = {f"conditions[1].defects[1].{key}": values}
    study = {"schema": 1, "name": "test", "base": str(case), "axes": axes}
    made = plan_study(make_study(study))
    cases = [made.case(point) for point in made.points]
    assert len(cases) == 2
    told = [str(one.conditions[0].defects[0]) for one in cases]
    assert told[0] != told[1]
    assert all(len(expand(one).runs) >= 2 for one in cases)


def test_zip_moves_axes_together() -> None:
    """Zipped axes give one case per position; a different number of values is refused."""
    axes = {"scenario.speed": ["200 km/h", "300 km/h"], "scenario.mean_force": ["120 N", "150 N"]}
    made = plan(axes, design="zip")
    assert made.shape == (2,)
    assert made.case(made.points[1]).scenario.mean_force == 150.0
    told = refusal({**axes, "settings.seed": {"seeds": 3}}, design="zip")
    assert (
        "need as many values (scenario.speed: 2, scenario.mean_force: 2, settings.seed: 3)" in told
    )


def test_range_is_written_in_its_unit() -> None:
    """A value inside a range is the case one gets by writing that value by hand."""
    made = plan({"scenario.speed": {"from": "200 km/h", "to": "320 km/h", "step": "40 km/h"}})
    by_hand = load_case("ac-simple", ["scenario.speed=240 km/h"])
    assert made.shape == (4,)
    assert made.case(made.points[1]).hash() == by_hand.hash()
    assert made.dimensions[0].axes[0].coordinates[1] == by_hand.scenario.speed


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ({"from": 1, "to": 2, "count": 3}, [1.0, 1.5, 2.0]),
        ({"from": "100 kN/m", "to": "10 MN/m", "count": 3, "scale": "log"}, [1e5, 1e6, 1e7]),
        ({"from": 3, "to": 1, "step": -1}, [3.0, 2.0, 1.0]),
        ({"from": 0.1, "to": 0.35, "step": 0.1}, [0.1, 0.2, 0.3]),
        ({"from": "50 kN/m", "to": 2e5, "step": "75 kN/m"}, [5e4, 1.25e5, 2e5]),
    ],
)
def test_ranges(given: dict[str, Any], values: list[float]) -> None:
    """Ranges by step and by count, linear and logarithmic, in one unit or several."""
    made = plan({"settings.contact_stiffness": given})
    assert made.dimensions[0].axes[0].coordinates == pytest.approx(values)


def test_whole_numbers_stay_whole() -> None:
    """A range over a field of whole numbers gives whole numbers, or is refused."""
    made = plan({"settings.nodes_between_droppers": {"from": 5, "to": 15, "step": 5}})
    assert made.dimensions[0].axes[0].coordinates == (5, 10, 15)
    told = refusal({"settings.nodes_between_droppers": {"from": 5, "to": 8, "count": 3}})
    assert "gives 6.5; whole numbers are needed here" in told


def test_latin_hypercube() -> None:
    """Every axis is cut into as many parts as there are samples, and each part is met once."""
    axes = {
        "settings.contact_stiffness": {"low": "50 kN/m", "high": "500 kN/m", "scale": "log"},
        "wires.contact.tension": {"low": "20 kN", "high": "24 kN"},
        "settings.nodes_between_droppers": {"low": 5, "high": 9},
        "scenario.speed": ["250 km/h", "300 km/h"],
    }
    made = plan(axes, samples=20, seed=4)
    assert made.shape == (2, 20)
    stiffness, tension, nodes = (
        np.array(a.coordinates, dtype=float) for a in made.dimensions[1].axes
    )
    parts = np.floor(20 * np.log10(stiffness / 5e4)).astype(int)
    assert sorted(parts) == list(range(20))
    assert sorted(np.floor((tension - 2e4) / 200.0).astype(int)) == list(range(20))
    assert set(nodes) == {5, 6, 7, 8, 9}
    again = plan(axes, samples=20, seed=4)
    assert [point.key for point in again.points] == [point.key for point in made.points]
    other = plan(axes, samples=20, seed=5)
    assert other.points[0].key != made.points[0].key


def test_variants_change_several_values() -> None:
    """A variant is a name for values that belong together."""
    variants = {
        "coarse": {"settings.nodes_between_droppers": 5, "settings.time_step": "2 ms"},
        "fine": {"settings.nodes_between_droppers": 15, "settings.time_step": "0.5 ms"},
    }
    made = plan({"mesh": {"variants": variants}})
    assert made.dimensions[0].axes[0].coordinates == ("coarse", "fine")
    fine = made.case(made.points[1]).settings
    assert (fine.nodes_between_droppers, fine.time_step) == (15, 0.0005)


def test_words_lists_and_items() -> None:
    """Axes may hold words, lists, and single items of lists."""
    made = plan(
        {
            "line.ends": ["anchored", "weighted"],
            "settings.section": [[4, 13], [5, 12]],
            "droppers.presag[5]": ["50 mm", "55 mm"],
        }
    )
    names = [axis.name for dimension in made.dimensions for axis in dimension.axes]
    assert names == ["ends", "section", "presag_5"]
    last = made.case(made.points[-1])
    assert last.settings.section == (5, 12)
    assert made.coordinates(made.points[-1]) == {
        "ends": "weighted",
        "section": "[5, 12]",
        "presag_5": 0.055,
    }


def test_refused_combination_stays_in_the_plan() -> None:
    """A combination that validation refuses is kept with its reason; others are computed."""
    made = plan({"scenario.speed": ["300 km/h", "600 km/h"], "settings.seed": {"seeds": 2}})
    assert [bool(point.problems) for point in made.points] == [False, False, True, True]
    assert "not below the wave speed" in made.points[2].problems[0]
    assert len(list(pending(made, set()))) == 2
    told = refusal({"scenario.speed": ["600 km/h", "700 km/h"]})
    assert "none of the 2 cases is valid" in told
    assert "not below the wave speed" in told


def test_all_faults_of_axes_are_told_together() -> None:
    """Unknown paths, wrong dimensions, doubled values and axes that overwrite each other."""
    told = refusal(
        {
            "scenario.sped": ["200 km/h"],
            "settings.contact_stiffness": ["5 kg"],
            "settings.seed": [1, 1],
            "line.gravity": {"from": 9, "to": 10, "step": -1},
            "droppers.presag": [[0.01]],
            "droppers.presag[2]": [0.01],
            "scenario.mean_force": ["150 N"],
            "scenario.uplift_force": ["150 N"],
            "mesh": {"variants": {"a": {"settings.sed": 1}}},
        }
    )
    for part in (
        "axes.scenario.sped: scenario.sped: unknown key; did you mean 'speed'?",
        "axes.settings.contact_stiffness: got '5 kg', which is a mass",
        "axes.settings.seed: holds 1 twice",
        "axes.line.gravity: the step does not lead",
        "axes.droppers.presag[2]: replaces what axes.droppers.presag sets",
        "axes.scenario.uplift_force: replaces what axes.scenario.mean_force sets",
        "axes.mesh: settings.sed: unknown key; did you mean 'seed'?",
    ):
        assert part in told, part


def test_too_many_cases_are_refused() -> None:
    """A grid that nobody can compute is refused with its number of cases."""
    axes = {"settings.seed": {"seeds": 1000}, "line.spans": {"from": 5, "to": 155, "step": 1}}
    assert "they give 151000 cases" in refusal(axes)


def test_base_beside_the_study(tmp_path: Path) -> None:
    """The base may be a file; a missing one is refused by name."""
    copy_case("ac-simple", tmp_path / "line.yaml")
    made = plan({"settings.seed": {"seeds": 2}}, base=str(tmp_path / "line.yaml"))
    assert made.case(made.points[0]).name == "line"
    assert "there is no such" in refusal({"settings.seed": [1]}, base=str(tmp_path / "no.yaml"))


def test_names_of_axes_are_different() -> None:
    """Axes whose paths end alike, or like a quantity of the table, get longer names."""
    made = plan(
        {
            "wires.contact.tension": ["22 kN"],
            "wires.messenger.tension": ["16 kN"],
            "scenario.uplift_force": ["150 N"],
        }
    )
    names = [axis.name for dimension in made.dimensions for axis in dimension.axes]
    assert names == ["wires_contact_tension", "wires_messenger_tension", "scenario_uplift_force"]


def test_key_follows_input_and_what_is_kept() -> None:
    """The key of a result changes with the case and with what is kept of it."""
    case = load_case("ac-simple")
    other = load_case("ac-simple", ["scenario.speed=250 km/h"])
    keys = {key_of(case), key_of(other), key_of(case, keep_runs=True)}
    assert len(keys) == 3
    assert key_of(load_case("ac-simple")) == key_of(case)


EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "studies").glob("*.yaml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_studies(path: Path) -> None:
    """Every study among the examples is valid in all its cases."""
    made = plan_study(load_study(path))
    assert len(made.points) > 1
    assert not any(point.problems for point in made.points)


def test_conditions_are_axes(tmp_path: Path) -> None:
    """A condition, its weather and every value of a defect can be an axis; a range of temperatures
    has a step in K, never in degrees."""
    text = (
        "include: ac-simple\nname: weather\nwires:\n"
        "  contact: {thermal_expansion: 17e-6}\n  messenger: {thermal_expansion: 17e-6}\n"
        "droppers: {thermal_expansion: 17e-6}\n"
        "conditions:\n  - {name: hot, temperature: 40 degC, reference: 15 degC}\n"
        "  - {name: broken, defects: [{kind: missing dropper, span: 5, dropper: 1}]}\n"
    )
    base = tmp_path / "weather.yaml"
    base.write_text(text, encoding="utf-8")
    warm = {"from": "-20 degC", "to": "40 degC", "step": "20 K"}
    axes: dict[str, Any] = {
        "condition": ["hot", "broken"],
        "conditions[1].temperature": warm,
        "conditions[2].defects[1].dropper": {"from": 1, "to": 9, "step": 4},
        "conditions[2].defects[1].kind": ["missing dropper", "slack dropper"],
    }
    made = plan(axes, base=str(base))
    assert made.shape == (2, 4, 3, 2)
    case = made.case(made.points[-1])
    assert case.condition == "broken"
    assert case.conditions[0].temperature == 40.0
    assert str(case.conditions[1].defects[0]) == "slack dropper: dropper 9 of span 5"
    told = refusal({"conditions[1].temperature": {**warm, "step": "20 degC"}}, base=str(base))
    assert "a difference of temperatures is in K" in told
