"""Limits of one's own: a copied file, corrected, used, and told in a client's words."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from tautwire.assessment.checks import Check
from tautwire.assessment.limits import load_limits
from tautwire.cli.app import run_command_line
from tautwire.cli.commands.run import criteria_of
from tautwire.errors import InputError

CHECK = Check(
    name="mean contact force",
    pantograph=None,
    value=100.0,
    limit=120.0,
    unit="N",
    sense="maximum",
    within=True,
    passed=None,
    standard="EN 50367",
    edition="2020",
    clause=None,
    verified=False,
    confidence="memory",
    note="",
)


def test_copy_is_the_package_file_until_it_is_corrected(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The copy loads to the same limits; a corrected value with who and when is used."""
    path = tmp_path / "our-limits.yaml"
    assert run_command_line(["limits", "--copy", str(path)]) == 0
    assert load_limits(path) == load_limits()
    text = path.read_text(encoding="utf-8").replace("factor: 0.3", "factor: 0.25", 1)
    signed = "verified: true\n    verified_by: A. Person\n    verified_on: '2026-11-28'"
    path.write_text(text.replace("verified: false\n", signed + "\n", 1), encoding="utf-8")
    profile = criteria_of("ac", None, path).limits
    assert profile is not None
    (limit,) = [one for one in profile.limits if one.id == "force-deviation"]
    assert (limit.verified, limit.value(80.0, 100.0, None)) == (True, 25.0)
    capsys.readouterr()
    assert run_command_line(["limits", "--limits", str(path), "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["limits"]
    assert [entry["id"] for entry in listed if entry["verified"]] == ["force-deviation"]


def test_nobody_verifies_anonymously(tmp_path: Path) -> None:
    """A limit that counts as verified says by whom and when."""
    path = tmp_path / "ours.yaml"
    run_command_line(["limits", "--copy", str(path)])
    text = path.read_text(encoding="utf-8").replace("verified: false\n", "verified: true\n", 1)
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="verified_by"):
        load_limits(path)


def test_copy_leaves_files_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An existing file is not replaced unasked."""
    path = tmp_path / "ours.yaml"
    path.write_text("mine", encoding="utf-8")
    assert run_command_line(["limits", "--copy", str(path)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("within", "verified", "words"),
    [
        (True, True, "within the limit"),
        (False, True, "not within the limit"),
        (True, False, "within the limit, which was not checked against the standard"),
        (None, False, "no value"),
    ],
)
def test_verdicts_in_a_client_s_words(within: bool | None, verified: bool, words: str) -> None:
    """A client reads whether a value keeps the limit, and whether the limit was checked."""
    check = replace(CHECK, within=within, verified=verified)
    assert check.words == words
    assert check.as_dict()["words"] == words


def test_faults_are_told_in_words(tmp_path: Path) -> None:
    """What is wrong in a file of limits or of span tables is said as in a case, not by pydantic."""
    path = tmp_path / "own.yaml"
    path.write_text("schema: 1\nlimits: [{standard: X, value: high, unit: N}, 3]\n", "utf-8")
    with pytest.raises(InputError) as caught:
        load_limits(path)
    told = "\n".join(caught.value.problems)
    assert "limits[1].edition: is missing" in told
    assert "limits[2]: got 3; expected a mapping" in told
    assert not re.search(r"Field required|Input should|validation", told)
