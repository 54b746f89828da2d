"""The template of an own line: plausible, loadable, every choice with its reason."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.cli.app import run_command_line
from tautwire.inputs.load import load_case, make_case
from tautwire.inputs.own_line import TEMPLATE, Wish, as_data, as_text, dropper_positions, template
from tautwire.model.build import build


@pytest.mark.parametrize("speed", [80, 160, 200, 250, 330])
@pytest.mark.parametrize("system", ["ac", "dc-1.5kv", "dc-3kv"])
def test_text_and_data_are_one_case(speed: float, system: str, tmp_path: Path) -> None:
    """The commented file and the plain data are the same case, for every system and speed."""
    choices = template(Wish("line", system=system, speed=speed / 3.6))  # pyright: ignore
    path = tmp_path / "line.yaml"
    path.write_text(as_text(choices), encoding="utf-8")
    case = load_case(path)
    assert case == make_case(as_data(choices))
    assert case.scenario.speed == pytest.approx(speed / 3.6)
    assert case.scenario.speed < 0.7 * case.wires.contact.wave_speed()


@pytest.mark.parametrize("speed", [80, 160, 250, 330])
def test_chosen_line_stands(speed: float) -> None:
    """Every dropper of a chosen line carries, and the arms carry no weight of the wire."""
    case = make_case(as_data(template(Wish("line", speed=speed / 3.6, spans=4))))
    shape = find_shape(build(case.with_(**{"settings.nodes_between_droppers": 4})))
    assert shape.dropper_forces.min() > 20.0
    assert shape.dropper_forces.max() < 250.0
    assert np.all(shape.arm_forces > 0.0)


@pytest.mark.parametrize("span", [12.0, 27.0, 40.0, 50.0, 65.0, 80.0])
def test_droppers_are_evenly_placed(span: float) -> None:
    """Droppers are symmetric, at most 7 m apart, the first at most 4.5 m from the support."""
    x = np.array(dropper_positions(span))
    assert x + x[::-1] == pytest.approx(span)
    assert np.diff(x).max() <= 7.001
    assert x[0] <= 4.5


def test_what_was_chosen_is_listed_until_it_is_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """``check`` lists every choice of the program; a changed or a given value is not on it."""
    path = tmp_path / "my-line.yaml"
    arguments = ["--speed", "200 km/h", "--contact", "RiS 120", "--contact-tension", "12 kN"]
    assert run_command_line(["new", str(path), *arguments]) == 0
    capsys.readouterr()
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('encumbrance: "1.4 m"', 'encumbrance: "1.6 m"'), encoding="utf-8")
    assert run_command_line(["check", str(path), "--json"]) == 0
    taken = json.loads(capsys.readouterr().out)["taken_over"][TEMPLATE]
    assert {"supports.closure", "wires.messenger", "line.ends", "droppers.presag"} <= set(taken)
    assert not {"supports.encumbrance", "wires.contact.tension", "scenario.speed"} & set(taken)
    case = load_case(path)
    assert (case.name, case.title) == ("my-line", "")
    assert case.wires.contact.tension == 12e3


def test_wrong_answers_are_all_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every answer that cannot be used is named, and no file is written."""
    path = tmp_path / "line.yaml"
    wrong = ["--speed", "fast", "--span", "200 m", "--contact", "RiX", "--ends", "loose"]
    assert run_command_line(["new", str(path), *wrong]) == 2
    told = capsys.readouterr().err
    assert "--speed: got 'fast', not a number" in told
    assert "--span: got '200 m'; must be between 10 and 100 m" in told
    assert "--contact: the catalogue has no contact wire or rope named 'RiX'" in told
    assert "--ends: got 'loose'; choose mid-point, weighted, anchored" in told
    assert not path.exists()


def test_an_existing_file_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """``new`` never replaces a file unasked."""
    path = tmp_path / "line.yaml"
    path.write_text("mine", encoding="utf-8")
    assert run_command_line(["new", str(path)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine"
