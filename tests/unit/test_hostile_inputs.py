"""Files made to do harm, or damaged: refused quickly, briefly, and without a word of others."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.inputs.reading.grouping import SHOWN
from tautwire.inputs.reading.recording import load_recording
from tautwire.studies.study_file import load_study
from tautwire.text import csv_text, printable, shortened, unprintable

HEAD = "schema: 1\ninclude: ac-simple\nname: mine\n"
SECRET = "correct horse battery staple"
PATIENCE = 6.0
"""Seconds of processor time: three times what a refusal may take (2 s), for slow machines."""


def refused(path: Path | str) -> list[str]:
    """Load a case that must be refused in time and return what is said."""
    start = time.process_time()
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert time.process_time() - start < PATIENCE
    return list(caught.value.problems)


def written(folder: Path, text: str, name: str = "mine.yaml") -> Path:
    """Write a case below the usual head."""
    path = folder / name
    path.write_text(HEAD + text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "value",
    [
        *("!!bool maybe", "!!bool true", "!!timestamp foo", "!!timestamp 2015-01-01", "!!set {a}"),
        *("!!float '1:30'", "!!int 5", "!!null x", "!!omap [a: 1]", "!!pairs [a: 1]", "!!str 5"),
        *(
            "!!binary YQ==",
            "!!python/name:os.system x",
            "!own x",
            "! 5",
            "!!seq [1]",
            "!!map {a: 1}",
        ),
    ],
)
def test_yaml_tags(value: str, tmp_path: Path) -> None:
    """No tag is read, whatever it stands for: plain YAML 1.2 scalars mean what they look like."""
    (told,) = refused(written(tmp_path, f"settings: {{seed: {value}}}\n"))
    assert "line 4, column 18: the tag" in told
    assert "write the value alone, text in quotes" in told


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("hexadecimal.toml", f"settings.seed = 0x{'f' * 5000}"),
        ("binary.toml", f"settings.seed = 0b{'1' * 64}"),
        ("decimal.toml", f"settings.seed = {'9' * 5000}"),
        ("short.toml", f"settings.seed = {'9' * 400}"),
        ("long.json", f'"settings": {{"seed": {"9" * 5000}}}'),
        ("short.json", f'"settings": {{"contact_stiffness": -{"9" * 20}}}'),
        ("long.yaml", f"settings: {{seed: {'9' * 5000}}}"),
        ("short.yaml", f"settings: {{contact_stiffness: {'1' * 400}}}"),
    ],
)
def test_giant_integers(name: str, text: str, tmp_path: Path) -> None:
    """Whole numbers beyond 64 bits are refused in every language (TOML 1.0 has the same bound)."""
    head = {".toml": 'name = "mine"\n', ".json": '{"name": "mine", ', ".yaml": "name: mine\n"}
    path = tmp_path / name
    path.write_text(head[path.suffix] + text + ("}" if path.suffix == ".json" else "\n"))
    (told,) = refused(path)
    assert "a whole number has more than 19 digits; write it as in 1e20" in told


@pytest.mark.parametrize("digits", [400, 5000])
def test_giant_numbers_in_a_table(digits: int, tmp_path: Path) -> None:
    """A cell of hundreds of digits is no finite length and no number of a support."""
    (tmp_path / "s.csv").write_text(f"support,x\n1,0\n{'1' * digits},{'9' * digits}\n")
    told = refused(written(tmp_path, "tables: {supports: s.csv}\n"))
    assert "line 3, column 'support': got '11111" in told[0]
    assert "line 3, column 'x': got" in told[1]
    assert "expected a length [m]" in told[1]
    assert max(map(len, told)) < 400


@pytest.mark.parametrize("value", ["2015-01-01", "2015-01-01T10:00:00Z", "10:00:00"])
def test_toml_dates(value: str, tmp_path: Path) -> None:
    """Dates of TOML are no values of a case."""
    path = tmp_path / "mine.toml"
    path.write_text(f"name = {value}\n")
    assert "name: got a date" in refused(path)[0] or "name: got a time" in refused(path)[0]


@pytest.mark.parametrize("code", ["\\u0000", "\\ud800", "\\u001b[2J", "\\u202e", "\\u0085"])
@pytest.mark.parametrize("key", ["include", "name", "title", "description"])
def test_control_characters(code: str, key: str, tmp_path: Path) -> None:
    """NUL, half surrogate pairs, escapes and marks that turn the text are named and refused."""
    values = {"include": "ac-simple", "name": "mine"} | {key: f"a{code}b"}
    pairs = ", ".join(f'"{name}": "{value}"' for name, value in values.items())
    path = tmp_path / "mine.json"
    path.write_text("{" + pairs + "}")
    number = code[2:6].upper()
    assert refused(path) == [f"{path}: {key}: holds the control character U+{number}; remove it"]


def test_control_characters_in_keys(tmp_path: Path) -> None:
    """A key is shown neither with nor without the control character in it."""
    path = tmp_path / "mine.json"
    path.write_text('{"settings": {"se\\u001bed": 1}}')
    told = f"{path}: settings: a key holds the control character U+001B; remove it"
    assert refused(path) == [told]


def test_many_droppers_in_a_span(tmp_path: Path) -> None:
    """Droppers without end are refused by their number, in a list and in a table."""
    places = ", ".join(f"{0.05 + 0.001 * i:.3f}" for i in range(40_000))
    (told,) = refused(written(tmp_path, f"droppers: {{positions: [{places}]}}\n"))
    assert told.endswith("droppers.positions: has 40000 values; give at most 200")
    rows = "".join(f"1,{i},{0.0005 * i:.4f},0\n" for i in range(1, 100_001))
    (tmp_path / "d.csv").write_text("span,dropper,position,presag\n" + rows)
    (told,) = refused(written(tmp_path, "tables: {droppers: d.csv}\n"))
    assert told.endswith("d.csv: has 100,000 rows; at most 50,000 are read")


def test_large_tables(tmp_path: Path) -> None:
    """20 MB of rows, of columns and of one cell are refused without reading the cells."""
    path = written(tmp_path, "tables: {supports: s.csv}\n")
    rows = "".join(f"{i},{i}.5\n" for i in range(1, 1_200_001))
    (tmp_path / "s.csv").write_text("support,x\n" + rows)
    assert "s.csv: has 1,200,000 rows; at most 50,000 are read" in refused(path)[0]
    (tmp_path / "s.csv").write_text("support,x," * 1_900_000 + "\n1,1\n")
    assert "has more than 1000 columns" in refused(path)[0]
    (tmp_path / "s.csv").write_text("support,x\n1,0\n2," + "5" * 19_000_000 + "\n")
    assert "is not a table (field larger" in refused(path)[0]


def test_record_full_of_faults(tmp_path: Path) -> None:
    """A long record without one number is refused in a sentence, in no time."""
    path = tmp_path / "run.csv"
    path.write_text("position,force\n" + "".join(f"{i},much\n" for i in range(500_000)))
    start = time.process_time()
    with pytest.raises(InputError) as caught:
        load_recording(path)
    assert time.process_time() - start < PATIENCE
    (told,) = caught.value.problems
    assert "'force' holds hardly any numbers ('much')" in told


@pytest.mark.parametrize(
    ("text", "last"),
    [
        ("".join(f"k{i}: 1\n" for i in range(15_000)), "k4: unknown key; known here"),
        (
            f"settings: {{{', '.join(f'time_stap{i}: 1' for i in range(15_000))}}}\n",
            "settings.time_stap4: unknown key; did you mean 'time_step'?",
        ),
        (
            f"settings: {{section: [{', '.join(['x'] * 15_000)}]}}\n",
            "settings.section: has 15000 values; give at most 2",
        ),
        (
            f"arms: 1\nsupports: {{encumbrance: [{', '.join(['1 kg'] * 15_000)}]}}\n",
            "supports.encumbrance[5] (support 5, x = 220 m): got '1 kg', which is a mass",
        ),
        (
            "sources: ["
            + ", ".join(f"{{path: a{i}, source: b, confidence: choice}}" for i in range(5_000))
            + "]\n",
            "sources: the path 'a4' leads to nothing",
        ),
    ],
)
def test_faults_by_the_thousand(text: str, last: str, tmp_path: Path) -> None:
    """Faults of one kind are told as the first few of them and a count."""
    told = refused(written(tmp_path, text))
    assert len(told) <= SHOWN + 2
    assert any(last in sentence for sentence in told), told
    assert sum(map(len, told)) < 3000


def test_counts_add_up(tmp_path: Path) -> None:
    """Every fault is counted once: those told and those behind the last of its kind."""
    keys = ", ".join(f"key{i}: 1" for i in range(23))
    told = refused(written(tmp_path, f"settings: {{{keys}}}\nscenario: {{{keys}}}\n"))
    assert len(told) == 2 * SHOWN
    assert [sentence.count("(and 18 more like this)") for sentence in told].count(1) == 2


@pytest.mark.parametrize("name", ["/proc/kmsg", "/proc/self/mem", "/proc/self/pagemap"])
def test_files_of_the_kernel(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files that wait or never end are not read; they say that they are empty."""
    if not Path(name).exists():
        pytest.skip(f"there is no {name}")
    monkeypatch.setenv("TAUTWIRE_ALLOW", "/")
    (told,) = refused(written(tmp_path, f"tables: {{supports: {name}}}\n"))
    assert told.startswith(f"{name}: is empty")


@pytest.mark.parametrize(
    "text",
    [
        "include: ../other.yaml\nname: a\n",
        "include: {outside}/other.yaml\nname: a\n",
        "include: link.yaml\nname: a\n",
        "name: a\ntables: {{supports: ../other.csv}}\n",
        "name: a\nsettings: {{include: ../other.yaml}}\n",
        "include: ac-simple\nname: a\nirregularities: {{unevenness: [{{kind: profile, table: "
        "../other.csv}}]}}\n",
        "include: ac-simple\nname: a\npantographs: [{{include: benchmark-2015-pantograph, "
        "name: f, roof_motion: {{table: ../other.csv}}}}]\n",
        "include: sub/mine.yaml\n",
    ],
)
def test_files_elsewhere(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case opens files of its folder only, unless its user allows others."""
    folder = tmp_path / "case"
    (folder / "sub").mkdir(parents=True)
    (folder / "link.yaml").symlink_to(tmp_path / "other.yaml")
    (folder / "sub" / "mine.yaml").write_text("include: ../../other.yaml\nname: b\n")
    (tmp_path / "other.yaml").write_text(f"name: x\ntitle: {SECRET}\nxyz: 1\n")
    (tmp_path / "other.csv").write_text(f"support\n{SECRET}\n")
    path = folder / "mine.yaml"
    path.write_text(text.format(outside=tmp_path))
    told = "\n".join(refused(path))
    assert "which is not in the folder of the file that was named" in told
    assert f"tautwire --allow {tmp_path} ..." in told
    assert SECRET not in told
    monkeypatch.setenv("TAUTWIRE_ALLOW", os.pathsep.join(["/nowhere", str(tmp_path)]))
    assert "is not in the folder" not in "\n".join(refused(path))


def test_base_of_a_study_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A study, too, opens cases of its folder only."""
    folder = tmp_path / "study"
    folder.mkdir()
    path = folder / "study.yaml"
    path.write_text("schema: 1\nname: s\nbase: ../a.yaml\naxes: {settings.seed: [1]}\n")
    with pytest.raises(InputError, match="which is not in the folder of the file that was named"):
        load_study(path)
    monkeypatch.setenv("TAUTWIRE_ALLOW", str(tmp_path))
    assert load_study(path).base == str(folder / "../a.yaml")


def test_named_file_may_lie_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The case that the user names is opened wherever it lies, and may include below."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "parts" / "speed.yaml").write_text("speed: 200 km/h\n")
    path = written(tmp_path, "scenario: {include: parts/speed.yaml}\n")
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert load_case("../mine.yaml").scenario.speed == pytest.approx(200 / 3.6)
    assert load_case(path).scenario.speed == pytest.approx(200 / 3.6)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("other.yaml", f"password: {SECRET}\n{SECRET}: 5\n"),
        ("other.yaml", f"{SECRET}\n"),
        ("other.yaml", f"- {SECRET}\n"),
        ("other.json", f'{{"{SECRET}": 1}}'),
        ("other.json", f"[{SECRET}]"),
        ("other.toml", f'"{SECRET}" = 1\n'),
        ("other.csv", f"{SECRET}:x:0:0:root:/root:/bin/sh\n{SECRET}\n"),
        ("other.csv", f"{SECRET},{SECRET}\n1,2\n"),
    ],
)
def test_foreign_files_are_not_quoted(name: str, text: str, tmp_path: Path) -> None:
    """What stands in a file that is neither case nor table is not repeated in messages."""
    (tmp_path / name).write_text(text)
    use = (
        f"tables: {{supports: {name}}}\n"
        if name.endswith("csv")
        else f"line: {{include: {name}}}\n"
    )
    told = "\n".join([*refused(written(tmp_path, use)), *refused(tmp_path / name)])
    assert name in told
    assert not any(word in told for word in SECRET.split())


def test_records_of_others_are_not_quoted(tmp_path: Path) -> None:
    """A file must have the headings of a recording before its cells are spoken of."""
    path = tmp_path / "shadow"
    path.write_text(f"{SECRET};x\n")
    with pytest.raises(InputError) as caught:
        load_recording(path)
    assert "is no recording that can be recognised" in str(caught.value)
    assert SECRET not in str(caught.value)


@pytest.mark.parametrize("suffix", ["", ".yaml"])
def test_name_too_long(suffix: str, tmp_path: Path) -> None:
    """A name of 300 characters is answered with a shorter name as the cure, in a short message."""
    (told,) = refused(str(tmp_path / ("x" * 5000 + suffix)))
    assert len(told) < 400
    if suffix:
        assert told.endswith("cannot be read (File name too long); choose a shorter name")


def test_cells_that_compute() -> None:
    """Texts that a spreadsheet would compute are written with an apostrophe; numbers are not."""
    cells = ["=1+1", "+x", "-x", "@x", "\tx", "-1.5", "+2", "-inf", "x=1", "", 3, -2.5, None]
    text = csv_text(["=a"], [cells])
    assert text == "'=a\n'=1+1,'+x,'-x,'@x,'\tx,-1.5,+2,-inf,x=1,,3,-2.5,\n"


def test_texts_are_made_printable() -> None:
    """Control characters become their number; letters of any language stay."""
    assert printable("a\x1b[31m\x9bb\u202ec\ud800\n") == "a<1B>[31m<9B>b<202E>c<D800>\n"
    assert (
        printable("Fahrdraht Überspannung 接触网 é\u200c")
        == "Fahrdraht Überspannung 接触网 é\u200c"
    )
    assert unprintable("é\n\t") == ""
    assert unprintable("\x7f") == "holds the control character U+007F; remove it"
    assert shortened("ab\n cd", 100) == "ab cd"
    assert shortened("a" * 60 + "b" * 60, 25) == "a" * 10 + " ... " + "b" * 10
