"""Study files: what they may say, and how faults are told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tautwire.errors import InputError
from tautwire.specs.study import Study
from tautwire.studies.study_file import load_study, make_study

BASE = {"schema": 1, "name": "test", "base": "ac-simple"}
SPEEDS = {"scenario.speed": ["200 km/h", "250 km/h"]}

YAML = """
schema: 1
name: from-file
base: my-line.yaml
axes:
  scenario.speed: {from: 200 km/h, to: 300 km/h, step: 50 km/h}
  settings.seed: {seeds: 3}
"""
TOML = """
schema = 1
name = "from-file"
base = "my-line.yaml"
[axes]
"scenario.speed" = {from = "200 km/h", to = "300 km/h", step = "50 km/h"}
"settings.seed" = {seeds = 3}
"""


def faults(**parts: Any) -> list[str]:
    """Return the sentences with which a study is refused."""
    with pytest.raises(InputError) as caught:
        make_study({**BASE, "axes": SPEEDS, **parts})
    return list(caught.value.problems)


def test_three_formats_say_the_same(tmp_path: Path) -> None:
    """A study reads alike from YAML, TOML and JSON."""
    as_json = json.dumps(
        {
            "schema": 1,
            "name": "from-file",
            "base": "my-line.yaml",
            "axes": {
                "scenario.speed": {"from": "200 km/h", "to": "300 km/h", "step": "50 km/h"},
                "settings.seed": {"seeds": 3},
            },
        }
    )
    texts = {"study.yaml": YAML, "study.toml": TOML, "study.json": as_json}
    studies = []
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        studies.append(load_study(tmp_path / name))
    assert studies[0] == studies[1] == studies[2]
    assert studies[0].base == str(tmp_path / "my-line.yaml")


def test_library_case_is_found_by_name(tmp_path: Path) -> None:
    """A base that is a library name stays one, wherever the file lies."""
    path = tmp_path / "study.yaml"
    path.write_text(YAML.replace("my-line.yaml", "ac-simple"))
    assert load_study(path).base == "ac-simple"


def test_all_faults_are_told_together() -> None:
    """Unknown keys, wrong words, wrong types and missing ends are named at once, with hints."""
    told = "\n".join(
        faults(
            desgn="grid",
            design="cross",
            samples=0,
            axes={
                "scenario.speed": {"from": "200 km/h", "to": "300 km/h"},
                "settings.seed": {"seeds": 0},
                "settings.time_step": {"low": 1, "hig": 3},
                "wires.contact.mass": 3,
                "line.spans": [],
            },
        )
    )
    for part in (
        "desgn: unknown key; did you mean 'design'?",
        "design: got 'cross'; choose 'grid' or 'zip'",
        "axes.scenario.speed: give either a step or a count",
        "axes.settings.seed.seeds: got 0",
        "axes.settings.time_step.high: is missing",
        "axes.settings.time_step.hig: unknown key; did you mean 'high'?",
        "axes.wires.contact.mass: got 3; the values of an axis are a list, {from, to",
        "axes.line.spans: is empty",
        "samples: got 0",
    ):
        assert part in told, part


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"axes": {}}, "axes: "),
        ({"axes": [1]}, "axes: got [1]; expected a mapping"),
        ({"base": 3}, "base: got 3; expected a text"),
        ({"name": "a\nb"}, "name: got 'a"),
        ({"schema": 2}, "schema: got 2"),
        ({"samples": 5}, "samples: is given, but no axis has {low, high}"),
        ({"axes": {"line.spans": {"low": 5, "high": 8}}}, "samples: is missing"),
        ({"axes": {"line.spans": {"from": [1], "to": 2, "step": 1}}}, "got [1]; expected a number"),
        (
            {"axes": {"line.spans": {"from": 1, "to": 2, "step": 1, "scale": "log"}}},
            "axes.line.spans.scale: got 'log' with a step; give a count",
        ),
    ],
)
def test_single_faults(parts: dict[str, Any], words: str) -> None:
    """Every fault names its place and what is allowed."""
    assert words in "\n".join(faults(**parts))


def test_missing_file_is_refused(tmp_path: Path) -> None:
    """A file that is not there, and one that is no study, are refused by name."""
    with pytest.raises(InputError, match="there is no such file"):
        load_study(tmp_path / "none.yaml")
    with pytest.raises(InputError, match="must end in"):
        load_study(tmp_path / "study.csv")
    (tmp_path / "list.yaml").write_text("[1, 2]")
    with pytest.raises(InputError, match="must be a mapping"):
        load_study(tmp_path / "list.yaml")


def test_every_field_is_documented() -> None:
    """Every field of a study file says what it is."""
    schema = Study.model_json_schema(by_alias=True)
    for spec in (schema, *schema["$defs"].values()):
        for name, field in spec.get("properties", {}).items():
            assert field.get("description", "").endswith("."), name
