"""Advice before computing: numbers and cure, and silence where nothing is wrong."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.line.pieces import Line
from tautwire.model.band import frequency_of, wave_length
from tautwire.model.build import build
from tautwire.model.preflight import Advice, preflight
from tautwire.model.resolution import resolution, size
from tautwire.specs.case import Case
from tautwire.specs.line.wire import Wire


def _advice(case: str = "ac-simple", **changes: Any) -> dict[tuple[str, str], Advice]:
    overrides = {path.replace("__", "."): value for path, value in changes.items()}
    found = preflight(load_case(case, overrides))
    return {(item.severity, item.topic): item for item in found}


def test_mesh_follows_from_the_band() -> None:
    """Without a number of nodes the mesh carries the band, and half of the elements do half less.

    The wave of 200 Hz ahead of a head at 320 km/h solves ``T k^2 + EI k^4 = m (w + v k)^2``.
    """
    case = load_case("ac-simple")
    found = resolution(case, expand(case))
    assert found.carries(200.0)
    assert not found.carries(230.0)
    wire, speed = case.wires.contact, case.scenario.speed
    number = 2.0 * np.pi / wave_length(wire, 200.0, speed)
    circular = np.sqrt((wire.tension + wire.bending_stiffness * number**2) / wire.mass) * number
    assert circular - speed * number == pytest.approx(2.0 * np.pi * 200.0, rel=1e-9)
    assert found.longest <= np.pi / number + 1e-9


def test_line_is_expanded_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """All advice reads the same pieces of the line."""
    calls = []

    def counted(case: Case) -> Line:
        calls.append(case.name)
        return expand(case)

    monkeypatch.setattr("tautwire.model.preflight.expand", counted)
    preflight(load_case("ac-simple"))
    assert calls == ["ac-simple"]


def test_elements_of_a_bare_string_at_rest() -> None:
    """A rope without bending stiffness has waves of c/f, ahead of a train (c - v)/f."""
    rope = Wire(tension=10e3, mass=1.0, axial_stiffness=1e7, bending_stiffness=0.0)
    assert wave_length(rope, 50.0, 0.0) == pytest.approx(2.0, rel=1e-9)
    assert wave_length(rope, 50.0, 60.0) == pytest.approx(0.8, rel=1e-9)
    assert frequency_of(rope, 0.8, 60.0) == pytest.approx(50.0, rel=1e-9)


def test_band_decides_the_step() -> None:
    """A band of 500 Hz asks for 0.4 ms, one of 20 Hz for no more than 1 ms; a given step stays."""
    steps = {
        band: load_case("ac-simple", {"settings.band": band}).settings.step() for band in (20, 500)
    }
    assert steps == {20: 1e-3, 500: pytest.approx(4e-4)}
    text = str(preflight(load_case("ac-simple", {"settings.time_step": "2 ms"}))[0])
    assert "carry 100 Hz of the band 0-200 Hz" in text
    assert "give 1 ms" in text


def test_counted_nodes_that_do_not_carry_the_band() -> None:
    """Nodes that are counted keep the paper's mesh (NAD 9: 0.71875 m), and are told as such."""
    coarse = _advice(settings__nodes_between_droppers=9)
    assert list(coarse) == [("note", "mesh")]
    text = str(coarse["note", "mesh"])
    assert "elements of up to 0.719 m of the wire 'contact'" in text
    assert "124 Hz" in text
    found = re.search(r"at least (\d+)$", text)
    assert found is not None
    least = int(found[1])
    assert not _advice(settings__nodes_between_droppers=least)
    assert ("note", "mesh") in _advice(settings__nodes_between_droppers=least - 1)
    assert ("warning", "mesh") in _advice(settings__nodes_between_droppers=4)


def test_elements_are_not_chosen_shorter_than_bending() -> None:
    """Just below the wave speed of a rope waves ahead are millimetres long; the cure is a band."""
    advice = _advice(wires__contact__bending_stiffness=0, scenario__speed="420 km/h")
    text = str(advice["note", "mesh"])
    assert "elements of up to 0.1 m" in text
    band = re.search(r"give settings.band: ([\d.]+) Hz", text)
    assert band is not None
    cured = _advice(
        wires__contact__bending_stiffness=0, scenario__speed="420 km/h", settings__band=band[1]
    )
    assert ("note", "mesh") not in cured


def test_size_is_known_before() -> None:
    """Degrees of freedom and steps are those of the computation."""
    case = load_case("ac-simple", {"line.spans": 3, "settings.section": [2, 2]})
    assert size(case).dof == 6 * build(case).mesh.node_count
    assert size(case).steps == 1744
    assert size(case).cpu_s() > 0.0
    assert size(case).cpu_s(is_compiled=False) > 10.0 * size(case).cpu_s()


def test_contact_resonance() -> None:
    """A head of 7.5 kg on 10 MN/m oscillates at 184 Hz: 1 ms is too long, 0.54 ms is not."""
    stiff = {"settings__contact_stiffness": "10 MN/m"}
    text = str(_advice(**stiff)["warning", "time step"])
    assert "184 Hz, 5.4 steps of 1 ms" in text
    assert "settings.time_step: 0.54 ms" in text
    assert not _advice(**stiff, settings__time_step="0.54 ms")


def test_sampling() -> None:
    """A step of 5 ms leaves nothing from 100 Hz on."""
    found = preflight(load_case("ac-simple", {"settings.time_step": "5 ms"}))
    assert any("nothing from 100 Hz on" in str(item) for item in found)
    assert ("refused", "time step") in _advice(settings__time_step="25 ms")


def test_ends_of_line() -> None:
    """Less than 1.5 spans beside the section are reported, from both ends."""
    text = str(_advice(settings__section=[2, 16])["warning", "ends of the line"])
    assert "1 span before and 1 span after" in text
    assert ("warning", "ends of the line") not in _advice(settings__section=[3, 15])


@pytest.mark.parametrize(("direction", "section"), [("+x", [1, 9]), ("-x", [9, 17])])
def test_start_of_section(direction: str, section: list[int]) -> None:
    """The section must not begin while the uplift force is still growing, in both directions."""
    advice = _advice(scenario__direction=direction, settings__section=section)
    assert "0 m after the start" in str(advice["warning", "start"])
    mirrored = _advice(scenario__direction="+x", settings__section=[9, 17])
    assert ("warning", "start") not in mirrored


def test_speed() -> None:
    """Above 0.7 of the wave speed the advice names a speed and a tension that suit."""
    text = str(_advice(scenario__speed="350 km/h")["warning", "speed"])
    assert "0.76 of the wave speed" in text
    assert "26.0 kN" in text
    assert ("warning", "speed") not in _advice(scenario__speed="320 km/h")


def test_force_of_the_air() -> None:
    """A fast train lifted as at standstill is told; a target or a force of the air is not."""
    still = {"pantographs[1].static_force": "70 N", "scenario.mean_force": None}
    told = {(a.severity, a.topic): a for a in preflight(load_case("ac-simple", still))}
    assert "70 N lift pantograph" in str(told["warning", "uplift force"])
    for more in (
        {"pantographs[1].aerodynamic": "0.00097 N/(km/h)^2"},
        {"pantographs[1].stages[1].force": {"per_speed_squared": "0.0005 N/(km/h)^2"}},
        {"scenario.mean_force": "150 N"},
        {"scenario.speed": "80 km/h"},
    ):
        topics = {a.topic for a in preflight(load_case("ac-simple", still | more))}
        assert "uplift force" not in topics, more


def test_trailing_pantograph() -> None:
    """A line on which the last pantograph cannot cross the section will be refused."""
    found = preflight(load_case("ac-simple-two-pantographs", {"line.spans": 8}))
    assert found[0].severity == "refused"
    assert "pantograph 'rear', 200 m behind, is still 95 m inside" in str(found[0])
    assert not any(
        item.severity == "refused" for item in preflight(load_case("ac-simple-two-pantographs"))
    )


def test_memory() -> None:
    """Histories of more than 1 GB are announced: 17 spans at 0.1 km/h have 34 million steps."""
    text = str(_advice(scenario__speed="0.1 km/h")["warning", "memory"])
    assert "3.4e+07 steps" in text
    assert "GB of memory" in text


def test_section_up_to_the_end() -> None:
    """A section may reach the end of the line; the strip that no passage reaches is left out."""
    assert ("refused", "line too short") not in _advice(settings__section=[4, 17])


def test_as_dict() -> None:
    """Advice is plain data for JSON."""
    (item,) = preflight(load_case("ac-simple", {"settings.nodes_between_droppers": 9}))
    assert set(item.as_dict()) == {"topic", "severity", "text", "cure"}
