"""Warnings about lines that nobody builds: value, usual range and place, and silence otherwise."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from tautwire.analyses.road.pipeline import run_case
from tautwire.analyses.road.shape import find_shape
from tautwire.catalogue.entries import list_entries
from tautwire.errors import InputError
from tautwire.inputs.load import load_case, make_case
from tautwire.model.build import build
from tautwire.model.plausibility import arm_shares, implausible_inputs, implausible_shape
from tautwire.specs.case import Case

LINE: dict[str, Any] = {
    "schema": 2,
    "name": "valley",
    "line": {"spans": 6, "span_length": "58 m"},
    "wires": {
        "contact": {"use": "AC-100 Cu", "tension": "10 kN"},
        "messenger": {"use": "Bz II 50/19", "tension": "10 kN"},
    },
    "supports": {
        "use": "light cantilever",
        "contact_height": "5.4 m",
        "encumbrance": "1.5 m",
        "contact_stagger": "0.25 m",
        "closure": "lift",
        "share": 0.2,
    },
    "droppers": {
        "use": ["Bz II 10/49", "light dropper clamps"],
        "positions": [8, 18.5, 29, 39.5, 50],
        "presag": ["0 mm", "18.3 mm", "24.4 mm", "18.3 mm", "0 mm"],
    },
    "pantographs": [{"use": "benchmark-2015", "name": "front", "static_force": "70 N"}],
    "scenario": {"speed": "120 km/h"},
    "settings": {"contact_stiffness": "50 kN/m", "section": [3, 4], "band": "20 Hz"},
}


def line(**changes: Any) -> Case:
    """Return the line with some values replaced, by path with two underscores for a dot."""
    return make_case(LINE, {path.replace("__", "."): value for path, value in changes.items()})


def told(case: Case) -> list[str]:
    """Return all that is unusual about a case and its static state."""
    found = [*implausible_inputs(case), *implausible_shape(case, find_shape(build(case)))]
    assert all(item.severity == "warning" for item in found)
    return [str(item) for item in found]


@pytest.mark.parametrize("case", [e.name for e in list_entries() if e.kind == "case"])
def test_lines_of_the_library_are_usual(case: str) -> None:
    """Nothing is said about lines that are built like this."""
    assert told(load_case(case, {"settings.band": 20})) == []


def test_own_line_is_usual() -> None:
    """Nor about the line of these tests, whose arms carry a fifth of the wire."""
    assert told(line()) == []


def test_arms_that_carry_the_wire() -> None:
    """Held above the first droppers, a wire lays itself on steep arms; closure lift cures it."""
    presag = [f"{sag} mm" for sag in (8, 26.3, 32.4, 26.3, 8)]
    held = {"supports__closure": "height", "supports__share": None}
    (text,) = told(line(**held, droppers__presag=presag))
    assert re.search(
        r"5 of 5 carry more than 0.6 of the contact wire .* \d\.\d\d at support 2", text
    )
    angle = re.search(r"they stand at ([\d.]+)", text)
    assert angle is not None
    assert float(angle[1]) > 20.0
    assert "supports.closure 'lift'" in text
    assert "at support 2" in told(line(**held))[0]
    assert told(line(supports__share=0.3, droppers__presag=presag)) == []


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_share_is_what_the_arms_carry(share: float) -> None:
    """The share given is the vertical force of the arms over the wire between the droppers."""
    case = line(supports__share=share)
    found = arm_shares(case, find_shape(build(case)))
    assert found == pytest.approx(share, abs=2e-3)


def test_share_belongs_to_lift() -> None:
    """A share with another closure, or beside a force, is refused where it stands."""
    for changes in ({"supports__closure": "height"}, {"supports__lift": "20 N"}):
        with pytest.raises(InputError, match=r"supports\.share: is given with"):
            line(**changes)


def test_arms_at_odd_angles() -> None:
    """Anchors 0.4 m higher lift the arms beside them out of the usual range; each is named."""
    heights = [5.8, *[5.4] * 5, 5.8]
    (text,) = told(
        line(supports__closure="height", supports__share=None, supports__contact_height=heights,
             droppers__positions=[4, 14, 24, 34, 44, 54],
             droppers__presag=[0, 0.0105, 0.0157, 0.0157, 0.0105, 0])
    )  # fmt: skip
    assert "2 of 5 stand outside 0 to 20°" in text or "at support 2" in text
    assert "at support 6" in text


TROLLEY: dict[str, Any] = {
    "schema": 2,
    "name": "loop",
    "line": {"spans": 5, "span_length": "38 m", "ends": "weighted"},
    "wires": {"contact": {"use": "AC-100 Cu", "tension": "9.5 kN"}},
    "supports": {
        "use": "light cantilever",
        "contact_height": "5.5 m",
        "contact_stagger": "0.2 m",
        "closure": "height",
    },
    "pantographs": [{"use": "benchmark-2015", "name": "front", "static_force": "70 N"}],
    "scenario": {"speed": "40 km/h"},
    "settings": {"contact_stiffness": "50 kN/m", "section": [3, 3], "band": "20 Hz"},
}


@pytest.mark.parametrize("closure", ["height", "lift"])
def test_contact_wire_alone_on_arms(closure: str) -> None:
    """Without droppers, which need not be said, arms stand at 50 degrees or let the wire fall by
    metres; the spring that is advised hangs it."""
    case = make_case(TROLLEY, {"supports.closure": closure})
    (text,) = told(case)
    odd = (
        r"stand outside 0 to 20°.*: 5\d\.\d° at"
        if closure == "height"
        else r"lies \d\.\d\d m below"
    )
    assert re.search(odd, text)
    assert "supports.closure 'spring' with supports.spring, as in {stiffness: 2 kN/m}" in text
    cured = {"supports.closure": "spring", "supports.spring": {"stiffness": "2 kN/m"}}
    assert told(make_case(TROLLEY, cured)) == []


def test_slack_droppers_are_named() -> None:
    """A dropper that is 0.9 m too long carries nothing, and is named with span and number."""
    shape = find_shape(build(line()))
    lengths = shape.dropper_lengths_unstrained[:5].tolist()
    rows = [list(lengths) for _ in range(6)]
    rows[2][1] += 0.9
    case = line(droppers__mode="length", droppers__presag=None, droppers__lengths=rows)
    texts = told(case)
    assert any(
        "1 of 30 droppers carry nothing at rest (usual: none): dropper 2 of span 3;" in text
        for text in texts
    )
    masts = [f"4/{number}" for number in range(1, 8)]
    named = told(case.with_(**{"line.masts": masts}))
    assert any("dropper 2 of span 3 (from mast 4/3);" in text for text in named)


def test_wires_that_are_none() -> None:
    """EA and EI of 150 mm2 with the mass of 70 mm2 are not one wire; both are told with numbers."""
    texts = [
        str(item)
        for item in implausible_inputs(
            line(wires__contact={
                "tension": "15 kN", "mass": "0.62 kg/m", "axial_stiffness": "15 MN",
                "bending_stiffness": "195 N m^2"})
        )
    ]  # fmt: skip
    assert len(texts) == 2
    assert "as copper it would have 70 mm2 and 215 GPa" in texts[0]
    assert "2.35 times that of a solid copper wire" in texts[1]
    assert all(text.startswith("wire contact: ") for text in texts)


def test_rounded_presag_of_pairs() -> None:
    """Half a millimetre is worth a quarter of the load of droppers in pairs; hundredths are not."""
    positions = [5.0, 14.5, 15.0, 28.75, 29.25, 43.0, 43.5, 53.0]
    sag = [30.0 * (1.0 - ((x - 29.0) / 24.0) ** 2) for x in positions]
    place = {"droppers__positions": positions, "wires__contact__tension": "24 kN"}
    rounded = line(**place, droppers__presag=[f"{round(value)} mm" for value in sag])
    (text,) = [str(item) for item in implausible_inputs(rounded)]
    found = re.search(r"dropper (\d) of span 1 by (\d+) N, (\d+) %", text)
    assert found is not None
    assert int(found[2]) == pytest.approx(0.5e-3 * 24e3 * (1 / 0.5 + 1 / 9.5), abs=0.6)
    exact = line(**place, droppers__presag=[f"{value:.3f} mm" for value in sag])
    assert not implausible_inputs(exact)


def test_stagger_on_one_side() -> None:
    """Four supports in a row on one side of straight track are told with their numbers."""
    case = line(supports__contact_stagger=[0.2, -0.2, -0.25, -0.2, -0.25, 0.2, -0.2])
    (item,) = implausible_inputs(case)
    assert "supports 2 to 5 have their stagger on the same side" in str(item)
    bend = [{"straight": "40 m"}, {"arc": "230 m", "radius": "900 m", "side": "left"},
            {"straight": "78 m"}]  # fmt: skip
    assert implausible_inputs(case.with_(track=bend)) == ()


@pytest.mark.parametrize(("wire", "end_z", "told"), [
    ("contact", 5.0, True), ("contact", 5.9, False), ("messenger", 5.0, False),
])  # fmt: skip
def test_stay_below_the_contact_wire(wire: str, end_z: float, told: bool) -> None:
    """A stay of the contact wire that leads below it is in the way of pantographs."""
    stay = {"name": "tie", "wire": wire, "span": 2, "at": 13.0, "end_y": 3.0, "stiffness": 1e5}
    case = make_case({**LINE, "stays": [{**stay, "end_z": end_z}]})
    found = [one for one in implausible_inputs(case) if one.topic == "stay"]
    assert [("'tie'" in one.text, "stays[1].end_z" in one.cure) for one in found] == [
        (True, True)
    ] * told


def test_base_spring_that_takes_the_force() -> None:
    """A spring of 40.7 kN/m on the roof leaves little of the force; the mean that acts is told."""
    stages = [{"mass": 8.0, "stiffness": 8e3, "damping": 30.0}, {"mass": 12.0, "stiffness": 40.7e3}]
    case = line(pantographs=[{"name": "metro", "stages": stages, "static_force": "110 N"}])
    run = run_case(case)
    (text,) = [text for text in run.warnings if text.startswith("mean force: ")]
    found = re.search(r"presses with ([\d.]+) N .* where 110.0 N act, −([\d.]+) %", text)
    assert found is not None
    assert float(found[2]) > 50.0
    assert "40700 N/m" in text
    stages[1] = {"mass": 12.0, "stiffness": 0.0, "damping": 90.0}
    even = line(pantographs=[{"name": "metro", "stages": stages, "static_force": "110 N"}])
    assert not [text for text in run_case(even).warnings if text.startswith("mean force")]


@pytest.mark.slow
def test_warnings_reach_every_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``check``, ``static``, ``run`` and its report say the same of an own line."""
    import json

    from tautwire.cli.app import run_command_line

    monkeypatch.chdir(tmp_path)
    data = make_case(LINE, {"supports.share": 1.0}).to_dict()
    Path("valley.yaml").write_text(yaml.safe_dump(data), encoding="utf-8")
    for command in ("check", "static", "run"):
        arguments = [command, "valley.yaml", "--json"]
        assert run_command_line([*arguments, *(["--out", "done"] if command == "run" else [])]) == 0
    page = Path("done/report.html").read_text(encoding="utf-8")
    document = json.loads(Path("done/results.json").read_text(encoding="utf-8"))
    for text in (page, " ".join(document["warnings"])):
        assert "carry more than 0.6 of the contact wire" in text
    assert np.isfinite(document["pantographs"][0]["sharp"]["mean_n"])


def test_a_soft_cantilever_is_told() -> None:
    """A heel that the pull of its arm moves by more than 50 mm is named with its stiffness."""
    soft, usual = (
        line(supports__cantilever={"arm": {"lateral": stiffness}}) for stiffness in (1e3, 2e5)
    )
    (found,) = [text for text in told(soft) if text.startswith("elastic cantilever")]
    assert "the heel at support 2 gives way by 0." in found
    assert "supports.cantilever.arm.lateral" in found
    assert not any(text.startswith("elastic cantilever") for text in told(usual))
