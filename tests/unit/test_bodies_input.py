"""Bodies in the line of a wire: keys, tables, refusals, and where results name them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tautwire.cli.app import run_command_line
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.model.plausibility import implausible_inputs
from tautwire.report.figures.line_figures import line_figure
from tautwire.report.parts.fitting_words import body_rows, stay_rows
from tautwire.report.parts.sections import line_section
from tautwire.report.parts.views import prepare

from .synthetic import make_run

HEAD = "schema: 2\ninclude: ac-simple\nname: mine\nline: {spans: 4}\nsettings: {section: [2, 3]}\n"
INSULATOR = "name: insulator, wire: contact, span: 2, at: 24.5 m, length: 1 m"
TABLE = """\
body;wire;span;position [m];length [mm];mass [kg];end mass [kg];EA [MN]
splice;messenger;1;21;;1.4;;
section insulator;contact;2;24.5;1600;11;0.8;12
"""


def written(folder: Path, text: str) -> Path:
    """Write a case file and return its path."""
    path = folder / "mine.yaml"
    path.write_text(HEAD + text, encoding="utf-8")
    return path


def test_a_table_says_the_same_as_keys(tmp_path: Path) -> None:
    """Rows of a table and a list in the case are the same bodies."""
    (tmp_path / "bodies.csv").write_text(TABLE, encoding="utf-8")
    from_table = load_case(written(tmp_path, "tables: {bodies: bodies.csv}\n"))
    listed = load_case(
        written(
            tmp_path,
            "bodies:\n"
            "  - {name: splice, wire: messenger, span: 1, at: 21 m, mass: 1.4 kg}\n"
            "  - {name: section insulator, wire: contact, span: 2, at: 24.5 m, length: 1.6 m,\n"
            "     mass: 11 kg, end_mass: 0.8 kg, axial_stiffness: 12 MN}\n",
        )
    )
    assert from_table.bodies == listed.bodies
    assert {s.path: s.source for s in from_table.sources}["bodies"] == "Table bodies.csv"
    heavier = load_case(tmp_path / "mine.yaml", ["bodies[2].mass=12 kg"])
    assert heavier.bodies[1].mass == 12.0


def test_a_wrong_cell_is_named(tmp_path: Path) -> None:
    """A body without its wire is refused with the line of its table."""
    text = TABLE.replace("section insulator;contact;2", "section insulator;kontakt;9")
    (tmp_path / "bodies.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_case(written(tmp_path, "tables: {bodies: bodies.csv}\n"))
    told = "\n".join(caught.value.problems)
    assert "bodies[2].wire (" in told
    assert "bodies.csv, line 3" in told
    assert "got 'kontakt'; there are the wires contact, messenger" in told
    assert "bodies[2].span" in told
    assert "got 9; the line has 4 spans" in told


REFUSED = {
    "no mass": (
        "{name: splice, wire: contact, span: 2, at: 20 m}",
        "bodies[1].mass (body 'splice'): is missing; a body without a length",
    ),
    "clamps without a length": (
        "{name: splice, wire: contact, span: 2, at: 20 m, mass: 1 kg, end_mass: 1 kg}",
        "bodies[1].end_mass (body 'splice'): belongs to a body with a length; give length too",
    ),
    "outside its span": (
        "{name: splice, wire: contact, span: 2, at: 60 m, mass: 1 kg}",
        "bodies[1].at (body 'splice'): got 60 m, outside the span of 55 m",
    ),
    "unknown tension length": (
        f"{{{INSULATOR}, tension_length: T1}}",
        "bodies[1].tension_length (body 'insulator'): got 'T1'; tension lengths: only one",
    ),
    "across an anchor": (
        "{name: insulator, wire: contact, span: 1, at: 0.2 m, length: 1 m}",
        "bodies[1] (insulator): there is no wire 'contact' from -0.3 m to 0.7 m; name wire",
    ),
    "beside a dropper": (
        "{name: insulator, wire: contact, span: 2, at: 21.27 m, length: 1 m}",
        "its end at 76.7700 m is 20 mm beside something else on the wire, at 76.7500 m (span 2, "
        "21.7500 m from the left); put it there or 50 mm away, with at or length",
    ),
    "on another": (
        f"{{{INSULATOR}}}, {{name: other, wire: contact, span: 2, at: 25.2 m, length: 1 m}}",
        "bodies[2] (other): lies on 'insulator' of the same wire, 79 m to 80 m; move one of them",
    ),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_refused(fault: str, tmp_path: Path) -> None:
    """A body that cannot be where it is told is refused with place and cure."""
    text, words = REFUSED[fault]
    with pytest.raises(InputError) as caught:
        expand(load_case(written(tmp_path, f"bodies: [{text}]\n")))
    assert words in "\n".join(caught.value.problems)


def test_a_heavy_body_between_droppers_is_told(tmp_path: Path) -> None:
    """20 kg half way between droppers 5.75 m apart dip by P L/(4 T), 13 mm under 22 kN."""
    odd = f"bodies: [{{{INSULATOR}, mass: 20 kg, end_mass: 1 kg}}]\n"
    (told,) = map(str, implausible_inputs(load_case(written(tmp_path, odd))))
    assert "'insulator' in 'contact' at 79.00 m pulls the contact wire down by 13 mm" in told
    light = f"bodies: [{{{INSULATOR}, mass: 3 kg}}]\n"
    assert implausible_inputs(load_case(written(tmp_path, light))) == ()


def test_results_name_bodies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The static state, its document, the report and its figure show every body."""
    stay = "name: tie, wire: contact, span: 2, at: 30 m, stiffness: 1 MN/m, end_y: 3 m, end_z: 6 m"
    body = f"bodies: [{{{INSULATOR}, mass: 3 kg, end_mass: 0.5 kg}}]"
    path = written(tmp_path, f"{body}\nstays: [{{{stay}}}]\n")
    assert run_command_line(["static", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    (body,) = document["shape"]["bodies"]
    assert (body["name"], body["wire"], body["start_m"]) == ("insulator", "contact", 79.0)
    assert body["heights_m"] == pytest.approx([5.25, 5.25], abs=0.02)
    run = make_run(load_case(path))
    view = prepare(run, "mine")
    assert body_rows(run.case, run.equilibrium)[0][:5] == (
        "insulator", "contact", "79.000", "80.000", "4.00"
    )  # fmt: skip
    titles = [getattr(block, "summary", "") for block in line_section([view]).blocks]
    assert {"Bodies in the line of wires", "Stays"} <= set(titles)
    assert stay_rows(run.case, run.equilibrium)[0][:3] == ("tie", "contact", "85.000")
    figure = line_figure(run.case, run.equilibrium, 1).to_figure()
    assert {"bodies", "stays"} <= {trace.name for trace in figure.data}
