"""Limits of one's own: a copied file, corrected, used, and told in a client's words."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.assessment.checks import Check, Criteria, checks
from tautwire.assessment.limits import limits_of, limits_text, load_limits
from tautwire.cli.app import run_command_line
from tautwire.cli.commands.run import criteria_of
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.inputs.load import make_case as make_case_of
from tautwire.report.pages.run_page import compose_report

from .synthetic import make_case, make_run

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
        (True, True, "within"),
        (False, True, "not within"),
        (True, False, "limit not checked against the standard"),
        (False, False, "limit not checked against the standard"),
        (None, False, "no value"),
    ],
)
def test_verdicts_in_a_client_s_words(within: bool | None, verified: bool, words: str) -> None:
    """A client reads whether a value keeps the limit, and whether the limit was checked."""
    check = replace(CHECK, within=within, verified=verified)
    assert check.words == words
    assert check.as_dict()["words"] == words


def _own_limits(folder: Path) -> Path:
    """Write the limits of the package with one that somebody checked and made stricter."""
    signed = "verified: true\n    verified_by: A. Person\n    verified_on: '2026-11-28'\n"
    text = limits_text().replace("factor: 0.3}", "factor: 0.25}", 1)
    path = folder / "ours.yaml"
    path.write_text(text.replace("verified: false\n", signed, 1), encoding="utf-8")
    return path


def test_case_names_its_limits(tmp_path: Path) -> None:
    """The case keeps what the file says, with the same hash, and is checked against it."""
    path = _own_limits(tmp_path)
    (tmp_path / "mine.yaml").write_text("schema: 2\ninclude: ac-simple\nlimits: ours.yaml\n")
    case = load_case(tmp_path / "mine.yaml")
    path.unlink()
    assert case.hash() == case.with_(limits="").hash()
    assert make_case_of(case.to_dict()) == case
    found = limits_of(case).limits
    assert [(one.id, one.verified_by) for one in found if one.verified] == [
        ("force-deviation", "A. Person")
    ]
    statistics = contact_statistics(make_run(case=make_case(spans=6).with_(limits=case.limits)))
    first, *others = checks(statistics, make_case(spans=6).with_(limits=case.limits))
    assert first.words in ("within", "not within")
    assert (first.checked_by, first.checked_on) == ("A. Person", "2026-11-28")
    assert {one.words for one in others} == {"limit not checked against the standard"}
    page = compose_report(make_run(case=make_case(spans=6).with_(limits=case.limits)))
    text = str(page.contents[0])
    assert "checked by A. Person, 2026-11-28" in text
    assert "remembered" not in text


def test_limits_of_a_run_replace_those_of_the_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``--limits`` counts before what the case names, and ``--set`` names another file."""
    path = _own_limits(tmp_path)
    monkeypatch.chdir(tmp_path)
    case = load_case("ac-simple", ["limits=ours.yaml"])
    assert limits_of(case) == load_limits(path)
    statistics = contact_statistics(make_run(case=make_case(spans=6)))
    named = Criteria(limits=load_limits()).checks(statistics, case)
    assert not any(check.verified for check in named)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "there is no such file"),
        ("a: [", "while parsing"),
        ("schema: 1\nlimits: 3\n", "limits: got 3"),
    ],
)
def test_bad_limits_of_a_case_are_refused(
    tmp_path: Path, content: str | None, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Missing, no YAML, no limits: told before anything is computed."""
    if content is not None:
        (tmp_path / "ours.yaml").write_text(content, encoding="utf-8")
    path = tmp_path / "mine.yaml"
    path.write_text("schema: 2\ninclude: ac-simple\nlimits: ours.yaml\n", encoding="utf-8")
    assert run_command_line(["run", str(path), "--out", str(tmp_path / "out")]) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out").exists()


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
