"""Advice before computing: numbers and cure, and silence where nothing is wrong."""

from __future__ import annotations

from typing import Any

import pytest

from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.line.pieces import Line
from tautwire.model.mesh import element_lengths
from tautwire.model.preflight import Advice, preflight
from tautwire.specs.case import Case


def _advice(case: str = "ac-simple", **changes: Any) -> dict[tuple[str, str], Advice]:
    overrides = {path.replace("__", "."): value for path, value in changes.items()}
    found = preflight(load_case(case, overrides))
    return {(item.severity, item.topic): item for item in found}


def test_element_lengths() -> None:
    """AC simple with NAD 9 has elements of 0.5625 m and 0.71875 m (Song et al. 2021, III.A)."""
    case = load_case("ac-simple")
    assert element_lengths(expand(case), case.settings) == (0.5625, 0.71875)


def test_line_is_expanded_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """All advice reads the same pieces of the line."""
    calls = []

    def counted(case: Case) -> Line:
        calls.append(case.name)
        return expand(case)

    monkeypatch.setattr("tautwire.model.preflight.expand", counted)
    preflight(load_case("ac-simple"))
    assert calls == ["ac-simple"]


def test_element_passing_in_wide_bands() -> None:
    """NAD 9 at 320 km/h is passed at 123.67 Hz (Song et al. 2021, III.A); NAD 14 clears 200 Hz."""
    advice = _advice()
    assert list(advice) == [("note", "mesh")]
    text = str(advice["note", "mesh"])
    assert "124 Hz" in text
    assert "nodes_between_droppers: 14" in text
    assert not _advice(settings__nodes_between_droppers=14)


def test_element_passing_in_headline_band() -> None:
    """Elements passed below 20 Hz endanger the headline figures; both cures are named."""
    text = str(_advice(settings__nodes_between_droppers=2)["warning", "mesh"])
    assert "15 Hz" in text
    assert "nodes_between_droppers: 3" in text
    assert "14 out of 0-200 Hz" in text


def test_contact_resonance() -> None:
    """A head of 7.5 kg on 10 MN/m oscillates at 184 Hz: 1 ms is too long, 0.54 ms is not."""
    stiff = {"settings__contact_stiffness": "10 MN/m", "settings__nodes_between_droppers": 14}
    text = str(_advice(**stiff)["warning", "time step"])
    assert "184 Hz, 5.4 steps of 1 ms" in text
    assert "settings.time_step: 0.54 ms" in text
    assert not _advice(**stiff, settings__time_step="0.54 ms")


def test_sampling() -> None:
    """A step of 5 ms leaves nothing from 100 Hz on."""
    advice = _advice(settings__time_step="5 ms")
    assert "nothing from 100 Hz on" in str(advice["note", "time step"])
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
    (item,) = preflight(load_case("ac-simple"))
    assert set(item.as_dict()) == {"topic", "severity", "text", "cure"}
