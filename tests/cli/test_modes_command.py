"""``tautwire modes`` and ``tautwire advise`` on the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from .conftest import Invoke

LINE = ("--set", "line.spans=4", "--set", "settings.nodes_between_droppers=5")


def test_modes_near_a_frequency(invoke: Invoke) -> None:
    """The document holds the modes, their checks and the lengths of the line."""
    outcome = invoke("modes", "ac-simple", *LINE, "--near", "20", "--count", "6", "--json")
    assert outcome.code == 0, outcome.err
    document = outcome.document
    assert len(document["modes"]) == 6
    assert document["counted_by_inertia"] == 6
    assert document["largest_residual"] < 1e-8
    assert document["orthogonality"] < 1e-8
    assert document["lengths_m"]["DD/2"] == pytest.approx(2.875)
    shares = [mode["share_contact_z"] for mode in document["modes"]]
    ranked = [shares[number - 1] for number in document["ranking"]]
    assert ranked == sorted(shares, reverse=True)


def test_first_modes_by_default(invoke: Invoke) -> None:
    """Without a frequency the lowest modes are found and listed by rising frequency; none lies
    below them, by Sylvester's count."""
    outcome = invoke("modes", "ac-simple", *LINE, "--count", "6")
    assert outcome.code == 0, outcome.err
    assert "the first 6 modes" in outcome.out
    listed = [float(f) for f in re.findall(r"^ *(\d+\.\d{4}) ", outcome.out, re.MULTILINE)]
    assert listed == sorted(listed)
    assert len(listed) == 6
    document = invoke("modes", "ac-simple", *LINE, "--count", "6", "--near", "0", "--json").document
    assert [f"{mode['frequency_hz']:.4f}" for mode in document["modes"]] == [
        f"{frequency:.4f}" for frequency in listed
    ]


def test_modes_for_people(invoke: Invoke) -> None:
    """The table fits a terminal of 80 columns."""
    outcome = invoke("modes", "ac-simple", *LINE, "--count", "5")
    assert outcome.code == 0, outcome.err
    assert "counted by inertia" in outcome.out
    assert max(map(len, outcome.out.splitlines())) <= 80


def test_modes_by_wavelength(invoke: Invoke, tmp_path: Path) -> None:
    """A named length of the line is a wavelength; tables, shapes and a page are written."""
    (tmp_path / "block.yaml").write_text("client: Valley Railway\n", encoding="utf-8")
    arguments = ("--wavelength", "dd/2", "--count", "2", "--out", tmp_path / "modes", "--json")
    signed = ("--project", tmp_path / "block.yaml")
    outcome = invoke("modes", "ac-simple", *LINE, *arguments, *signed)
    assert outcome.code == 0, outcome.err
    document = outcome.document
    assert document["wavelength_m"] == pytest.approx(2.875)
    assert document["searched"] > 10
    assert set(document["files"]) == {"modes.json", "modes.csv", "mode-shapes.csv", "modes.html"}
    assert len((tmp_path / "modes" / "modes.csv").read_text().splitlines()) == 1 + len(
        document["modes"]
    )
    page = (tmp_path / "modes" / "modes.html").read_text(encoding="utf-8")
    assert "Pre-sag" in page
    assert "<dd>Valley Railway</dd>" in page


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--near", "-3"], "near: got -3 Hz"),
        (["--count", "0"], "count: got 0"),
        (["--wavelength", "3 kg"], "which is a mass"),
        (["--wavelength", "XX/2"], "name of a length of the line: span, DD, SD, DD/2"),
        (["--wavelength", "0.5"], "longest_element"),
    ],
)
def test_wrong_requests(invoke: Invoke, arguments: list[str], words: str) -> None:
    """A request that cannot be met is refused with exit code 2 and what is allowed."""
    outcome = invoke("modes", "ac-simple", *LINE, *arguments)
    assert outcome.code == 2
    assert words in " ".join(outcome.err.split())


def test_advice(invoke: Invoke) -> None:
    """The advice names lengths, cut-off, contact stiffness and mesh for the case at hand."""
    outcome = invoke("advise", "ac-simple", *LINE, "--band", "50", "--json")
    assert outcome.code == 0, outcome.err
    document = json.loads(outcome.out)
    assert document["cutoff"]["frequency_hz"] == pytest.approx(80.0)
    by_name = {entry["name"]: entry for entry in document["lengths"]}
    assert by_name["SD/4"]["frequency_hz"] == pytest.approx(79.01, abs=0.01)
    candidates = document["contact_stiffness"]["candidates"]
    resonances = {c["contact_stiffness_n_per_m"]: c["head_resonance_hz"] for c in candidates}
    assert resonances[2e5] == pytest.approx(26.5, abs=0.1)
    assert document["mesh"][0]["topic"] == "mesh"


def test_advice_for_people(invoke: Invoke) -> None:
    """The advice is readable at 80 columns; a band without sense is refused."""
    outcome = invoke("advise", "ac-simple", *LINE, "--band", "20")
    assert outcome.code == 0, outcome.err
    assert "this case" in outcome.out
    assert max(map(len, outcome.out.splitlines())) <= 80
    assert invoke("advise", "ac-simple", "--band", "0").code == 2
