"""Bad input ends in an exit code and a message with place and cure; nothing is left half-done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from .conftest import SHORT, Invoke, Outcome

HEAD = "schema: 1\ninclude: ac-simple\nname: mine\n"
STATIC = ("static", "ac-simple", "--set", "line.spans=4",
          "--set", "settings.nodes_between_droppers=3")  # fmt: skip


def _write(name: str, content: str | bytes) -> Callable[[], None]:
    data = content.encode() if isinstance(content, str) else content
    return lambda: _ignore(Path(name).write_bytes(data))


def _ignore(_: object) -> None:
    return None


def _sparse() -> None:
    with Path("huge.yaml").open("wb") as file:
        file.truncate(100_000_000)


def _alias_bomb() -> None:
    rows = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    rows += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 10)]
    Path("bomb.yaml").write_text("\n".join(rows), encoding="utf-8")


def _foreign_netcdf() -> None:
    import h5netcdf

    with h5netcdf.File("foreign.nc", "w") as file:
        file.dimensions = {"x": 3}


def _nothing() -> None:
    return None


@dataclass(frozen=True)
class Bad:
    """A command line that must be refused."""

    name: str
    arguments: tuple[str, ...]
    words: tuple[str, ...]
    prepare: Callable[[], None] = _nothing
    code: int = 2


def _set(name: str, override: str, *words: str) -> Bad:
    return Bad(name, ("check", "ac-simple", "--set", override), words)


def _file(name: str, file: str, content: str | bytes, *words: str) -> Bad:
    return Bad(name, ("check", file), words, _write(file, content))


VALUES = [
    _set("wrong unit", "wires.contact.tension=22 km/h", "wires.contact.tension", "a force [N]"),
    _set("unknown unit", "line.span_length=55 yards", "line.span_length", "expected a length"),
    _set("unknown key", "supports.lfit=1", "supports.lfit", "did you mean 'lift'?"),
    _set("negative mass", "wires.contact.mass=-1.35", "wires.contact.mass", "greater than 0"),
    _set("dropper outside span", "droppers.positions[9]=60 m", "outside the span of 55 m",
         "droppers hang between 0.05 m and 54.95 m"),
    _set("too few pre-sags", "droppers.presag=[0, 24 mm]", "droppers.presag", "one value per"),
    _set("speed above wave speed", "scenario.speed=500 km/h", "scenario.speed", "459.6 km/h"),
    _set("not a number", "wires.contact.tension=.nan", "wires.contact.tension", "finite number"),
    _set("infinite", "settings.contact_stiffness=.inf", "settings.contact_stiffness", "finite"),
    _set("no spans", "line.spans=0", "line.spans", "at least 1"),
    _set("half a span", "line.spans=2.5", "line.spans", "whole number"),
    _set("section outside the line", "settings.section=[10, 20]", "settings.section", "17"),
    _set("start behind half of the line", "settings.start=500 m", "settings.start", "got 500 m",
         "the line is 935 m long", "nearer to the anchor"),
    Bad("start behind the section",
        ("check", "ac-simple", "--set", "settings.start=400 m", "--set", "settings.section=[2, 4]"),
        ("from 400 m to 535 m never meets", "settings.section")),
    _set("section backwards", "settings.section=[9, 4]", "settings.section", "[first, last]"),
    _set("no time step", "settings.time_step=0 s", "settings.time_step", "greater than 0"),
    _set("HHT parameter", "settings.integrator={method: hht, alpha: -0.5}",
         "settings.integrator.alpha", "at least"),
    _set("direction", "scenario.direction=left", "scenario.direction", "'+x' or '-x'"),
    _set("both forces", "scenario={speed: 80, mean_force: 150, uplift_force: 150}",
         "scenario.uplift_force", "keep mean_force"),
    _set("list per support", "supports.contact_stagger=[0.2, -0.2]", "supports.contact_stagger",
         "18 supports"),
    _set("override without value", "line.spans", "line.spans", "path=value"),
    _set("override of nothing", "line.spand=3", "line.spand", "did you mean 'spans'?"),
    _set("malformed override", "line.spans=[1, 2", "line.spans", "malformed"),
    _set("index from zero", "droppers.presag[0]=1 mm", "droppers.presag[0]", "numbered from 1"),
    _set("tolerance of another step control",
         "settings.step_control={method: variable, duration_tolerance: 1 ms}",
         "settings.step_control.duration_tolerance", "'method: adaptive'"),
    _set("unevenness of a negative length",
         "irregularities.unevenness=[{kind: bump, position: 9 m, length: -1 m, rise: 1 mm}]",
         "irregularities.unevenness[1].length", "at least 0.02 m"),
    _set("stitch wire", "line.stitch_wire=18 m", "unknown key", "given as wires"),
]  # fmt: skip
FILES = [
    _file("empty file", "empty.yaml", "", "empty.yaml: is empty", "--copy my-line.yaml"),
    _file("no mapping", "list.yaml", "- 1\n- 2\n", "list.yaml: must be a mapping", "not a list"),
    _file("malformed YAML", "bad.yaml", "line: [1, 2\n", "bad.yaml: line 2", "expected"),
    _file("malformed JSON", "bad.json", '{"line": }', "bad.json: cannot be read as JSON", "line 1"),
    _file("malformed TOML", "bad.toml", "line = \n", "bad.toml: cannot be read as TOML", "line 1"),
    _file("repeated key", "twice.yaml", "name: a\nname: b\n", "line 2", "keep one of them"),
    _file("not text", "noise.yaml", bytes(range(256)), "noise.yaml", "UTF-8"),
    _file("unknown feature", "turnout.yaml", HEAD + "turnout: true\n",
          "not modelled yet", "Not modelled yet"),
    _file("schema", "old.yaml", HEAD.replace("schema: 1", "schema: 7"), "schema", "1"),
    _file("trailing pantograph", "short.yaml",
          HEAD + "line: {spans: 6}\npantographs:\n"
          "  - {include: benchmark-2015-pantograph, name: a}\n"
          "  - {include: benchmark-2015-pantograph, name: b, behind: 250 m}\n",
          "pantograph 'b', 250 m behind", "add spans (line.spans)"),
    Bad("alias bomb", ("check", "bomb.yaml"), ("bomb.yaml", "write values out"), _alias_bomb),
    Bad("100 MB", ("check", "huge.yaml"), ("huge.yaml: has 100.0 MB", "CSV"), _sparse),
    Bad("directory", ("check", "."), (".: is a directory", "file in it")),
    Bad("device", ("check", "/dev/null"), ("/dev/null", "no such file")),
    Bad("no such file", ("check", "ac-simpel"), ("ac-simpel", "'ac-simple'")),
    Bad("a pantograph is no case", ("check", "benchmark-2015-pantograph"),
        ("is a pantograph, not a case", "include:")),
    Bad("missing column", ("check", "case.yaml"), ("droppers.csv", "'position'"),
        lambda: (_write("droppers.csv", "span,dropper\n1,1\n")(),
                 _write("case.yaml", HEAD + "tables: {droppers: droppers.csv}\n")())[0]),
]  # fmt: skip
LINES = [
    Bad("pushing dropper", (*STATIC, "--set", "droppers.presag[5]=70 mm", "--out", "out"),
        ("dropper 5 of span 1, x = 27.50 m, would have to push", "droppers.presag")),
    Bad("installation that pushes",
        (*STATIC, "--set", "irregularities.installation={of: height, amplitude: 30 mm}",
         "--set", "settings.seed=1", "--out", "out"),
        ("dropper 2 of span 1, x = 10.25 m, would have to push", "irregularities.installation",
         "settings.seed")),
    Bad("arm without pull", (*STATIC, "--set", "supports.contact_stagger=[0,0,0,0,0]", "--set",
                             "supports.closure=height", "--out", "out"),
        ("steady arm at support 2, x = 55.00 m", "supports.contact_stagger")),
    Bad("given arm without pull", (*STATIC, "--set", "supports.contact_stagger=[0,0,0,0,0]",
                                   "--out", "out"),
        ("support 2, x = 55.00 m: the contact wire runs straight", "supports.contact_stagger")),
    Bad("pushing arm",
        (*STATIC, "--set", "supports.closure=arm",
         "--set", "supports.arm_end_y=[null, 1.0, -1.4, 1.0, null]",
         "--set", "supports.arm_end_z=[null, 5.5, 5.5, 5.5, null]", "--out", "out"),
        ("steady arm at support 2, x = 55.00 m, would have to push", "on the other side")),
    Bad("trailing pantograph", ("run", "ac-simple-two-pantographs", "--set", "line.spans=5",
                                "--out", "out"),
        ("line too short", "pantograph 'rear', 200 m behind", "add spans (line.spans)")),
]  # fmt: skip
RESULTS = [
    Bad("no such result", ("report", "nothing.nc"), ("nothing.nc: does not exist", "(.nc)")),
    Bad("a text is no result", ("report", "text.nc"),
        ("text.nc: is not a netCDF-4 file", "compute it again"), _write("text.nc", "a,b\n1,2\n")),
    Bad("an empty result", ("report", "empty.nc"), ("empty.nc: the file is empty", "again"),
        _write("empty.nc", "")),
    Bad("a foreign result", ("report", "foreign.nc"), ("not a tautwire result", "tautwire run"),
        _foreign_netcdf),
    Bad("a damaged result", ("report", "cut.nc"), ("cut.nc", "compute it again"),
        _write("cut.nc", b"\x89HDF\r\n\x1a\n" + bytes(90))),
    Bad("folder as result", ("report", "."), ("is a folder", "(.nc)")),
    Bad("no such measurement", ("compare", "nothing.nc", "nothing.csv"), ("nothing.nc",)),
    Bad("unit of the offset", ("compare", "a.nc", "b.csv", "--offset", "2 kg"),
        ("--offset: got '2 kg', which is a mass", "a length [m]")),
    Bad("copy over a file", ("cases", "ac-simple", "--copy", "mine.yaml"),
        ("mine.yaml: exists already", "--force"), _write("mine.yaml", "mine")),
    Bad("copy into nowhere", ("cases", "ac-simple", "--copy", "no/mine.yaml"), ("no", "folder")),
    Bad("copy of nothing", ("cases", "ac-simpel", "--copy", "mine.yaml"), ("ac-simpel", "holds")),
    Bad("copy without name", ("cases", "--copy", "mine.yaml"), ("--copy", "ac-simple")),
    Bad("unknown study", ("reproduce", "en50318-2003"), ("en50318-2003", "'en50318-2002'")),
    Bad("supply system", ("run", "ac-simple", "--system", "dc"), ("--system", "dc-3kv")),
    Bad("free uplift", ("run", "ac-simple", "--free-uplift", "tall"), ("--free-uplift", "length")),
    Bad("unknown option", ("run", "ac-simple", "--speed", "300"), ("--speed",)),
    Bad("two ways to repeat", ("reproduce", "song2021", "--quick", "--identify"),
        ("--quick", "--identify")),
    Bad("unknown command", ("simulate", "ac-simple"), ("simulate",)),
    Bad("no case", ("run",), ("CASE",)),
]  # fmt: skip
FOLDERS = [
    Bad("out is a file", (*STATIC, "--out", "taken"), ("--out taken: is a file", "another folder"),
        _write("taken", "mine")),
    Bad("out below a file", (*STATIC, "--out", "taken/inside"), ("--out taken/inside", "another"),
        _write("taken", "mine")),
    Bad("out in a place for no files", (*STATIC, "--out", "/proc/tautwire"),
        ("--out /proc/tautwire: cannot be written to", "choose another folder")),
    Bad("out with a name too long", (*STATIC, "--out", "x" * 300),
        ("cannot be written to (File name too long); choose a shorter name",)),
    Bad("copy with a name too long", ("cases", "ac-simple", "--copy", "x" * 300 + ".yaml"),
        ("cannot be written (File name too long); choose a shorter name",)),
    Bad("report into a folder", ("report", "a.nc", "--out", "."), ("--out .: is a folder", "file")),
    Bad("report into nowhere", ("report", "a.nc", "--out", "no/report.html"),
        ("--out no/report.html: the folder no does not exist", "make it")),
]  # fmt: skip
BAD = [*VALUES, *FILES, *LINES, *RESULTS, *FOLDERS]


def _check_refused(bad: Bad, outcome: Outcome) -> None:
    assert outcome.code == bad.code, outcome.err
    assert "Traceback" not in outcome.out + outcome.err
    assert "please report" not in outcome.err
    told = " ".join(outcome.err.split())
    for word in bad.words:
        assert word in told, (word, told)


@pytest.mark.parametrize("bad", BAD, ids=[f"{b.arguments[0]} {b.name}" for b in BAD])
def test_bad_input(bad: Bad, invoke: Invoke) -> None:
    """Each bad input is refused with place and cure, and leaves no file behind."""
    bad.prepare()
    before = sorted(Path().rglob("*"))
    outcome = invoke(*bad.arguments)
    _check_refused(bad, outcome)
    assert outcome.out == ""
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize("bad", [VALUES[0], FILES[0], LINES[0], RESULTS[1]], ids=lambda b: b.name)
def test_bad_input_as_json(bad: Bad, invoke: Invoke) -> None:
    """With ``--json`` the same problems stand in one JSON document."""
    bad.prepare()
    outcome = invoke(*bad.arguments, "--json")
    _check_refused(bad, outcome)
    error = outcome.document["error"]
    assert error["kind"] in {"input", "model"}
    assert any(bad.words[0] in problem for problem in error["problems"])


def test_usage_as_json(invoke: Invoke) -> None:
    """Even a wrong option leaves one JSON document when JSON was asked for."""
    outcome = invoke("run", "ac-simple", "--bogus", "--json")
    assert outcome.code == 2
    assert outcome.document["error"]["kind"] == "usage"


def test_all_errors_at_once(invoke: Invoke) -> None:
    """One call lists every fault of an input, numbered."""
    outcome = invoke(
        "check", "ac-simple", "--json", "--set", "wires.contact.mass=-1",
        "--set", "line.spans=0", "--set", "scenario.speed=9 kg",
    )  # fmt: skip
    assert outcome.code == 2
    assert len(outcome.document["error"]["problems"]) == 3
    assert "3 problems" in outcome.err


def test_unexpected_error(invoke: Invoke, monkeypatch: pytest.MonkeyPatch) -> None:
    """A fault of the program itself is one sentence and a request to report it."""

    def broken(*_: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("tautwire.model.preflight.preflight", broken)
    monkeypatch.setattr("tautwire.cli.commands.inputs.check.preflight", broken)
    outcome = invoke("check", "ac-simple", "--json")
    assert outcome.code == 1
    assert outcome.document["error"]["kind"] == "internal"
    assert "please report" in outcome.err
    assert "Traceback" not in outcome.err


def test_full_disk(invoke: Invoke, monkeypatch: pytest.MonkeyPatch) -> None:
    """When a file cannot be written the results are still shown, and the exit code is 1."""

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tautwire.cli.commands.static.save_equilibrium", full)
    outcome = invoke(*STATIC, "--out", "out", "--json")
    assert outcome.code == 1
    assert "out/static.nc: cannot be written (No space left on device)" in outcome.err
    assert outcome.document["shape"]["iterations"] > 0
    assert outcome.document["error"]["kind"] == "output"
    assert sorted(path.name for path in Path("out").iterdir()) == [
        "design.csv",
        "droppers.csv",
        "elasticity.csv",
        "line.xlsx",
        "static.html",
        "static.json",
        "supports.csv",
        "workshop.xlsx",
    ]


def test_failed_run_keeps_what_it_has(invoke: Invoke, monkeypatch: pytest.MonkeyPatch) -> None:
    """A passage that does not converge ends with 1, a reason, and a result marked as failed."""
    from dataclasses import replace

    from tautwire.numerics.motion import backend
    from tautwire.results.storage import load_run
    from tautwire.status import Status

    made = backend.make_stepper

    def failing(*arguments: object) -> object:
        stepper = made(*arguments)  # pyright: ignore[reportArgumentType]
        advance = stepper.advance
        failed = lambda steps: replace(advance(steps), status=Status.NOT_CONVERGED)  # noqa: E731
        monkeypatch.setattr(stepper, "advance", failed)
        return stepper

    monkeypatch.setattr("tautwire.analyses.road.dynamics.make_stepper", failing)
    outcome = invoke("run", "ac-simple", *SHORT, "--out", "out", "--json")
    assert outcome.code == 1
    assert outcome.document["status"] == "failed"
    assert "settings.time_step" in outcome.document["error"]["problems"][0]
    assert outcome.document["pantographs"][0]["sharp"]["mean_n"] is None
    stored = load_run("out/run.nc")
    assert stored.status == "failed"
    assert stored.time.size == 5
