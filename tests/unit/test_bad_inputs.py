"""Bad input is refused with a message that names the place and the cure, never a traceback."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.cli.folders import default_folder
from tautwire.errors import InputError
from tautwire.inputs.load import load_case, make_case
from tautwire.model.build import build
from tautwire.model.preflight import preflight
from tautwire.specs.checks import dropper_lengths

HEAD = "schema: 1\ninclude: ac-simple\nname: mine\n"

# What stands in the case file below HEAD, and words that the message must contain: place, cure.
BAD_VALUES = {
    "wrong unit": (
        "wires: {contact: {tension: 22 kg}}",
        ["wires.contact.tension: got '22 kg', which is a mass; expected a force [N]", "'22 kN'"],
    ),
    "unknown unit": (
        "line: {span_length: 55 yards}",
        ["line.span_length: got '55 yards'", "unknown unit symbol 'yards'", "expected a length"],
    ),
    "unknown key": (
        "wires: {contact: {tensoin: 22 kN}}",
        ["wires.contact.tensoin: unknown key; did you mean 'tension'?"],
    ),
    "unknown key without likeness": (
        "settings: {xyz: 1}",
        ["settings.xyz: unknown key; known here are: contact_stiffness, band"],
    ),
    "key below a value": (
        "settings: {time_step: {value: 1 ms}}",
        ["settings.time_step: got {'value': '1 ms'}; expected a time [s], for example '1 ms'"],
    ),
    "mass of nearly nothing": (
        "wires: {contact: {mass: 1e-320}}",
        ["wires.contact.mass: got 1e-320, too small to be meant; give 0 or a usual value"],
    ),
    "speed of nearly nothing": (
        "scenario: {speed: 1 mm/h}",
        ["scenario.speed: got '1 mm/h' (2.77778e-07 m/s); must be at least 0.01 m/s"],
    ),
    "negative mass": (
        "wires: {contact: {mass: -1.35}}",
        ["wires.contact.mass: got -1.35; must be greater than 0 kg/m (typical: 0.6 to 1.4 kg/m)"],
    ),
    "negative mass with unit": (
        "droppers: {mass: -117 g/m}",
        ["droppers.mass: got '-117 g/m' (-0.117 kg/m); must be at least 0 kg/m"],
    ),
    "dropper outside the span": (
        "droppers: {positions: [4.5, 10.25, 16, 21.75, 27.5, 33.25, 39, 44.75, 60]}",
        [
            "droppers.positions[9] (dropper 9 of every span): got 60 m, outside the span of 55 m",
            "between 0.05 m and 54.95 m",
        ],
    ),
    "dropper at the support": (
        "droppers: {positions: [0.01, 10.25, 16, 21.75, 27.5, 33.25, 39, 44.75, 50.5]}",
        ["droppers.positions[1]", "less than 0.05 m beyond the support", "from left to right"],
    ),
    "droppers out of order": (
        "droppers: {positions: [4.5, 16, 10.25, 21.75, 27.5, 33.25, 39, 44.75, 50.5]}",
        ["droppers.positions[3]", "beyond dropper 2 at 16 m; list the positions from left to"],
    ),
    "too few pre-sags": (
        "droppers: {presag: [0, 24 mm]}",
        ["droppers.presag: has 2 values for 9 droppers", "give one value per dropper"],
    ),
    "too few lists": (
        "droppers: {presag: [[0], [0]]}",
        ["droppers.presag: has 2 lists for 17 spans; give one list per span, or one list for all"],
    ),
    "pre-sag in millimetres without unit": (
        "droppers: {presag: [0, 24, 41, 52, 55, 52, 41, 24, 0]}",
        ["droppers.presag[2] (dropper 2 of every span): got 24", "did you mean '24 mm'?"],
    ),
    "a curve written as stagger": (
        "supports: {contact_stagger: [0.2, -13.9, -24.8]}",
        ["supports.contact_stagger[2] (support 2, x = 55 m): got -13.9", "'track' says"],
    ),
    "pre-sag is a text": (
        "droppers: {presag: flat}",
        ["droppers.presag: got 'flat'; expected a list [...] or a list of lists, one per span"],
    ),
    "list where one value is due": (
        "supports: {messenger_stagger: {left: 0.2}}",
        ["supports.messenger_stagger: got {'left': 0.2}; expected the word 'contact' or a single"],
    ),
    "too few supports": (
        "supports: {encumbrance: [1.2, 1.3]}",
        ["supports.encumbrance: has 2 values; 17 spans have 18 supports", "one value per support"],
    ),
    "too few arm ends": (
        "supports: {closure: arm, arm_end_y: [null, 1, null], arm_end_z: [null, 5.5, null]}",
        ["supports.arm_end_y: has 3 values; 17 spans have 18 supports"],
    ),
    "short span": (
        "line: {spans: 2, span_length: [55, 0.5]}",
        ["line.span_length[2] (span 2): got 0.5; must be at least 1 m (typical: 40 to 65 m)"],
    ),
    "stagger of nothing": (
        "supports: {messenger_stagger: null}",
        ["supports.messenger_stagger: got nothing; expected the word 'contact' or a single value"],
    ),
    "stagger too large, given with a unit": (
        "supports: {contact_stagger: [0.2, 200 cm]}",
        ["supports.contact_stagger[2] (support 2, x = 55 m): got '200 cm' (2 m); must be at most"],
    ),
    "faults in a line that is not valid": (
        "line: {span_length: flat}\nsupports: {contact_stagger: [5 s]}\n"
        "droppers: {presag: [[5 s]]}",
        ["supports.contact_stagger[1] (support 1): got", "(dropper 1 of span 1): got '5 s'"],
    ),
    "missing arm end": (
        (
            "line: {spans: 2}\nsupports: {closure: arm, arm_end_y: [null, null, null], "
            "arm_end_z: [null, 5.5, null]}"
        ),
        ["supports.arm_end_y[2] (support 2, x = 55 m): is missing; only the two anchors"],
    ),
    "length mode without lengths": (
        "droppers: {mode: length}",
        ["droppers.lengths: is missing: mode 'length' needs one value per dropper"],
    ),
    "unknown word": (
        "supports: {closure: hight}",
        ["supports.closure: got 'hight'; choose 'height', 'lift', 'arm' or 'spring'", "mean"],
    ),
    "unknown word that stands for a mapping": (
        "line: {ends: fixed}",
        ["line.ends: got 'fixed'; choose 'anchored' or 'weighted'"],
    ),
    "spring without stiffness": (
        "supports: {closure: spring}",
        ["supports.spring: is missing: closure 'spring' needs it", "{stiffness: 300 N/m}"],
    ),
    "speed above wave speed": (
        "scenario: {speed: 460 km/h}",
        ["scenario.speed: got 460.0 km/h, not below the wave speed", "459.6 km/h; lower the speed"],
    ),
    "speed without unit": (
        "scenario: {speed: 320}",
        ["scenario.speed: got 320; must be at most 250 m/s", "did you mean '320 km/h'?"],
    ),
    "not a number": (
        "settings: {contact_stiffness: .nan}",
        ["settings.contact_stiffness: got nan, not a finite number", "'200 kN/m'"],
    ),
    "infinite": (
        "settings: {contact_stiffness: 1e999}",
        ["settings.contact_stiffness: got inf, not a finite number"],
    ),
    "true is no number": (
        "settings: {nodes_between_droppers: true}",
        ["settings.nodes_between_droppers: got True; expected a whole number"],
    ),
    "fraction of a node": (
        "settings: {nodes_between_droppers: 9.5}",
        ["settings.nodes_between_droppers: got 9.5; expected a whole number"],
    ),
    "too few nodes": (
        "settings: {nodes_between_droppers: 1}",
        ["settings.nodes_between_droppers: got 1; must be at least 2"],
    ),
    "yes is no boolean": (
        "settings: {store_shapes: yes}",
        ["settings.store_shapes: got 'yes'; expected true or false"],
    ),
    "alpha out of range": (
        "settings: {integrator: {method: hht, alpha: -0.5}}",
        ["settings.integrator.alpha: got -0.5; must be at least -0.333333"],
    ),
    "section outside the line": (
        "settings: {section: [4, 18]}",
        ["settings.section: got [4, 18]; the line has 17 spans", "leave it out for the default"],
    ),
    "half a section": (
        "settings: {section: [4]}",
        ["settings.section: has too few values. First and last span"],
    ),
    "section of three": (
        "settings: {section: [4, 5, 6]}",
        ["settings.section: has 3 values; give at most 2"],
    ),
    "start beyond the line": (
        "settings: {start: 935 m}",
        ["settings.start: got 935 m; the line is 935 m long"],
    ),
    "both forces": (
        "scenario: {mean_force: 169 N, uplift_force: 174 N}",
        ["scenario.uplift_force: is given together with scenario.mean_force; keep mean_force"],
    ),
    "no force": (
        "scenario: {mean_force: null}",
        ["pantographs[1].static_force (pantograph 'front'): the uplift force is 0 N; give"],
    ),
    "negative mean force": (
        "scenario: {mean_force: {constant: 1 N, per_speed_squared: -1 N/(m/s)^2}}",
        ["scenario.mean_force: gives -7900.23 N at 320.0 km/h; the mean force must be positive"],
    ),
    "forces for two pantographs": (
        "scenario: {uplift_force: [150 N, 150 N]}",
        ["scenario.uplift_force: has 2 values for 1 pantographs; give one value each"],
    ),
    "no stages": (
        "pantographs: [{name: front, stages: []}]",
        ["pantographs[1].stages (pantograph 'front'): is empty; give at least 1"],
    ),
    "no pantographs": ("pantographs: []", ["pantographs: is empty; give at least 1"]),
    "stage without mass": (
        "pantographs: [{name: front, stages: [{stiffness: 50 N/m}]}]",
        [
            (
                "pantographs[1].stages[1].mass (stage 1 of pantograph 'front'): is missing: Mass "
                "of the stage. Expected: a mass [kg], for example '0.165 kg'"
            )
        ],
    ),
    "pantograph without name": (
        "pantographs: [{include: benchmark-2015-pantograph}]",
        ["pantographs[1].name (pantograph 1): is missing: Name used in results"],
    ),
    "name of two lines": ('name: "a\\nb"', ["name: got 'a", "expected a name without control"]),
    "name that is a number": ("title: 320", ["title: got 320; expected a text (put a number in"]),
    "empty name": (
        "pantographs: [{include: benchmark-2015-pantograph, name: ''}]",
        ["pantographs[1].name (pantograph ''): got ''; expected a text that is not empty"],
    ),
    "long name": (f"name: {'x' * 61}", ["name: got 'xxx", "expected a shorter text"]),
    "stiffness of nothing": (
        "droppers: {stiffness: null}",
        ["droppers.stiffness: got nothing; expected a mapping with the keys spring, axial"],
    ),
    "same name twice": (
        (
            "pantographs: [{include: benchmark-2015-pantograph, name: a}, "
            "{include: benchmark-2015-pantograph, name: a, behind: 200 m}]"
        ),
        ["pantographs[2].name (pantograph 'a'): got 'a' again; give every pantograph its own"],
    ),
    "leader behind itself": (
        "pantographs: [{include: benchmark-2015-pantograph, name: a, behind: 5}]",
        ["pantographs[1].behind (pantograph 'a'): got 5 m; the first pantograph leads"],
    ),
    "pantographs out of order": (
        (
            "pantographs: [{include: benchmark-2015-pantograph, name: a}, "
            "{include: benchmark-2015-pantograph, name: b}]"
        ),
        ["pantographs[2].behind (pantograph 'b'): got 0 m, not behind pantograph 1"],
    ),
    "train longer than the line": (
        (
            "pantographs: [{include: benchmark-2015-pantograph, name: a}, "
            "{include: benchmark-2015-pantograph, name: b, behind: 930 m}]"
        ),
        ["pantographs[2].behind (pantograph 'b'): got 930 m", "lengthen the line (line.spans)"],
    ),
    "stages given as a number": (
        "pantographs: [{name: front, stages: 3}]",
        ["pantographs[1].stages (pantograph 'front'): got 3; expected a list, as in [1, 2, 3]"],
    ),
    "wires given as a list": (
        "wires: [1, 2]",
        ["wires: got [1, 2]; expected a mapping with the keys contact, messenger"],
    ),
    "stitch wire": (
        "stitch_wire: {length: 18 m}",
        ["stitch_wire: unknown key; did you mean 'wires'?"],
    ),
    "twin contact wire": (
        "wires: {contact_2: {tension: 22 kN}}",
        ["wires.contact_2.mass: is missing", "wires.contact_2.axial_stiffness: is missing"],
    ),
    "trade words": (
        "supports: {systemHeight: 1.4 m, wire-height: 5.3 m, stagger: 0.2 m, grade: 2}\n"
        "line: {Festpunkt: 3, Systemhöhe: 1.2}",
        [
            "supports.systemHeight: unknown key; did you mean 'encumbrance'?",
            "supports.wire-height: unknown key; did you mean 'contact_height'?",
            "supports.stagger: unknown key; did you mean 'contact_stagger'?",
            "line.Systemhöhe: unknown key; it is given as supports.encumbrance",
            "supports.grade: unknown key; it is given as track.profile",
            "line.Festpunkt: unknown key; it is given as tension_lengths",
        ],
    ),
    "words that mean something in one place": (
        "wires: {contact: {count: 2, weight: 1.35}}\nsettings: {count: 3}",
        [
            "wires.contact.count: unknown key; it is given as wires",
            "wires.contact.weight: unknown key; did you mean 'mass'?",
            "settings.count: unknown key; known here are",
        ],
    ),
    "curve": ("line: {radius: 3000 m}", ["line.radius: unknown key; it is given as track.radius"]),
    "overlap": ("line: {overlap: 3}", ["line.overlap: unknown key; it is given as overlaps"]),
    "source of nothing": (
        "sources: [{path: wires.contact.tensoin, source: a book, confidence: one source}]",
        ["sources: the path 'wires.contact.tensoin' leads to nothing", "did you mean 'tension'?"],
    ),
    "source without confidence": (
        "sources: [{path: wires.contact.tension, source: a book}]",
        ["(entry for 'wires.contact.tension'): is missing: 'two sources', 'one source'"],
    ),
    "sources that are no list": ("sources: a book", ["sources: expected a list of {path: ..."]),
    "other schema": ("schema: 2", ["the key 'schema' is given twice; keep one of them"]),
    "include of nothing": (
        "wires: {contact: {include: ac-simpel}}",
        ["ac-simpel: there is no such case in the library", "did you mean 'ac-simple'?"],
    ),
    "include of a number": (
        "wires: {contact: {include: 5}}",
        ["wires.contact.include: got 5; give one library name or file"],
    ),
    "missing table": (
        "tables: {supports: nowhere.csv}",
        ["nowhere.csv: there is no such file; check the path"],
    ),
    "unknown table": (
        "tables: {dropper: droppers.csv}",
        ["tables.dropper: unknown table; did you mean 'droppers'?"],
    ),
    "table that is no path": ("tables: {supports: 5}", ["tables.supports: got 5; give the path"]),
    "tables that are no mapping": ("tables: supports.csv", ["tables: expected {supports: file"]),
    "roof motion twice": (
        (
            "pantographs: [{include: benchmark-2015-pantograph, name: a, "
            "roof_motion: {table: roof.csv, time: [0, 1]}}]"
        ),
        ["pantographs[1].roof_motion: give either {table: file.csv} or time and height"],
    ),
    "profile twice": (
        "irregularities: {unevenness: [{kind: profile, table: wire.csv, x: [0, 1]}]}",
        ["irregularities.unevenness[1]: give either {table: file.csv} or x and height"],
    ),
    "missing profile": (
        "irregularities: {unevenness: [{kind: profile, table: nowhere.csv}]}",
        ["nowhere.csv: there is no such file; check the path"],
    ),
    "uniform errors without amplitude": (
        "irregularities: {installation: {of: height}}",
        ["irregularities.installation.amplitude: is missing; 'uniform' needs it"],
    ),
    "errors of another distribution": (
        "irregularities: {installation: {of: height, amplitude: 2 mm, deviation: 1 mm}}",
        ["irregularities.installation.deviation: does not belong to 'uniform'; leave it out"],
    ),
    "errors of height in length mode": (
        (
            "droppers: {mode: length, lengths: [1, 1, 1, 1, 1, 1, 1, 1, 1]}\n"
            "irregularities: {installation: {of: height, amplitude: 2 mm}}"
        ),
        ["irregularities.installation.of: got 'height', but droppers.mode 'length'", "length"],
    ),
    "too few errors": (
        "irregularities: {installation: {of: length, distribution: table, values: [1 mm]}}",
        ["irregularities.installation.values: has 1 values for the 9 droppers of span 1"],
    ),
    "too few lists of errors": (
        "irregularities: {installation: {of: length, distribution: table, values: [[0], [0]]}}",
        ["irregularities.installation.values: has 2 lists for 17 spans; give one list per span"],
    ),
    "errors in metres": (
        "irregularities: {installation: {of: height, amplitude: 2}}",
        ["irregularities.installation.amplitude: got 2; must be at most 0.5 m", "'2 mm'"],
    ),
    "unevenness of an unknown kind": (
        "irregularities: {unevenness: [{kind: wavy}]}",
        ["irregularities.unevenness[1].kind: got 'wavy'; choose 'uniform', 'gaussian'"],
    ),
    "spectrum without densities": (
        (
            "irregularities: {unevenness: [{kind: spectrum, wavenumbers: [0.1, 2], "
            "shortest: 0.5 m, longest: 10 m}]}"
        ),
        ["irregularities.unevenness[1].densities: is missing; 'spectrum' needs it"],
    ),
    "spectrum with too few densities": (
        (
            "irregularities: {unevenness: [{kind: spectrum, wavenumbers: [0.1, 2], "
            "densities: [1e-7], shortest: 0.5 m, longest: 10 m}]}"
        ),
        ["unevenness[1].densities: has 1 values for 2 wavenumbers; give one for each"],
    ),
    "wavenumbers out of order": (
        (
            "irregularities: {unevenness: [{kind: spectrum, wavenumbers: [2, 0.1], "
            "densities: [1e-7, 1e-7], shortest: 0.5 m, longest: 10 m}]}"
        ),
        ["unevenness[1].wavenumbers[2]: got 0.1 after 2; must increase"],
    ),
    "wavelengths exchanged": (
        (
            "irregularities: {unevenness: [{kind: power law, level: 1e-7, reference: 1, "
            "exponent: 2, shortest: 6 m, longest: 0.3 m}]}"
        ),
        ["unevenness[1].shortest: got 6 m, not below longest, 0.3 m"],
    ),
    "bump beyond the line": (
        "irregularities: {unevenness: [{kind: bump, position: 2 km, length: 1 m, rise: 1 mm}]}",
        ["irregularities.unevenness[1].position: got 2000 m; the line is 935 m long"],
    ),
    "unknown step control": (
        "settings: {step_control: clever}",
        ["settings.step_control: got 'clever'; choose 'constant', 'variable' or 'adaptive'"],
    ),
    "tolerance of another step control": (
        "settings: {step_control: {method: constant, gap_tolerance: 0.1 mm}}",
        ["settings.step_control.gap_tolerance: belongs to 'method: variable', not to 'constant'"],
    ),
    "two tolerances": (
        (
            "settings: {step_control: {method: variable, gap_tolerance: 0.1 mm, "
            "force_tolerance: 5 N}}"
        ),
        ["settings.step_control.force_tolerance: is given with gap_tolerance; keep one"],
    ),
    "duration as a length": (
        "settings: {step_control: {method: adaptive, duration_tolerance: 0.2 mm}}",
        ["step_control.duration_tolerance: got '0.2 mm', which is a length; expected a time"],
    ),
    "no losses at all": (
        "settings: {step_control: {method: adaptive, most_losses: 0}}",
        ["settings.step_control.most_losses: got 0; must be at least 1"],
    ),
}

# Whole files that cannot be parsed, and words that the message must contain.
BAD_FILES = {
    "empty.yaml": ("  \n", ["is empty", "tautwire cases ac-simple --copy"]),
    "comment.yaml": ("# nothing\n", ["must be a mapping of keys to values", "not nothing"]),
    "list.yaml": ("- 1\n- 2\n", ["must be a mapping of keys to values", "not a list"]),
    "text.yaml": ("hello\n", ["must be a mapping", "not a text"]),
    "number.json": ("5", ["must be a mapping", "not a single value"]),
    "bracket.yaml": ("a: [1\n", ["line 2, column 1: while parsing a flow sequence"]),
    "tab.yaml": ("a:\n\tb: 1\n", ["line 2, column 1", "'\\t' that cannot start any token"]),
    "twice.yaml": ("a: 1\na: 2\n", ["line 2, column 1: the key 'a' is given twice; keep one"]),
    "twice.json": ('{"a": 1, "a": 2}', ["the key 'a' is given twice; keep one of them"]),
    "twice.toml": ("a = 1\na = 2\n", ["cannot be read as TOML", "overwrite"]),
    "key.yaml": ("1: 2\n", ["line 1, column 1: a key must be a word"]),
    "listkey.yaml": ("? [a]\n: 1\n", ["a key must be a word"]),
    "two.yaml": ("a: 1\n---\nb: 2\n", ["line 2, column 1: expected a single document"]),
    "code.yaml": (
        "a: !!python/object:os.system x\n",
        ["line 1, column 4: the tag 'tag:yaml.org"],
    ),
    "self.yaml": ("a: &x [*x]\n", ["line 1, column 4: an alias refers to itself"]),
    "deep.yaml": ("a: " + "[" * 5000, ["nested too deeply; 30 levels are allowed"]),
    "deep.json": ("[" * 100_000, ["nested too deeply; 30 levels are allowed"]),
    "deep-enough.json": ('{"a":' * 40 + "1" + "}" * 40, ["nested too deeply; 30 levels"]),
    "deep.toml": ("a = " + "[" * 100_000, ["nested too deeply; 30 levels are allowed"]),
    "digits.yaml": (
        "a: " + "1" * 5000,
        ["line 1, column 4: a whole number has more than 19"],
    ),
    "control.yaml": ("a: \x01\n", ["cannot be read as YAML"]),
    "nan.json": ('{"a": NaN}', ["cannot be read as JSON: NaN is not a finite number"]),
    "broken.json": ('{"a": ', ["cannot be read as JSON", "line 1 column 7"]),
    "broken.toml": ("a = \n", ["cannot be read as TOML"]),
    "schema.yaml": (
        "schema: 3\n",
        ["schema: got 3; this program reads versions 1 and 2"],
    ),
    "true.yaml": ("schema: true\n", ["schema: got True; this program reads versions 1 and 2"]),
    "none.yaml": ("name: x\n", ["schema: is missing; write 'schema: 2'", "wires: is missing"]),
    "case.text": ("schema: 1\n", ["is no case file; its name must end in .yaml, .yml, .toml"]),
    "include.yaml": ("include: include.yaml\n", ["includes itself", "remove one 'include'"]),
}


def problems_of(path: Path | str) -> str:
    """Load a case that must be refused and return what is said."""
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert str(caught.value) == "\n".join(caught.value.problems)
    return str(caught.value)


@pytest.mark.parametrize("fault", BAD_VALUES)
def test_bad_value(fault: str, tmp_path: Path) -> None:
    """The message names the file, the path of the value, what was got and what to do."""
    text, words = BAD_VALUES[fault]
    path = tmp_path / "mine.yaml"
    head = HEAD.replace("name: mine\n", "") if text.startswith("name") else HEAD
    path.write_text(head + text + "\n", encoding="utf-8")
    told = problems_of(path)
    assert [word for word in words if word not in told] == [], told
    assert ".yaml" in told or ".csv" in told or fault == "include of nothing"


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_file(name: str, tmp_path: Path) -> None:
    """The message names the file, the place in it and what to do."""
    text, words = BAD_FILES[name]
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    told = problems_of(path)
    assert [word for word in [name, *words] if word not in told] == [], told


def test_all_faults_at_once(tmp_path: Path) -> None:
    """Faults of single values and contradictions between valid parts come together."""
    path = tmp_path / "mine.yaml"
    path.write_text(
        HEAD + "wires: {contact: {tension: 22 kg}}\n"
        "droppers: {positions: [60], presag: [0]}\n"
        "settings: {section: [1, 99], colour: red}\n"
        "scenario: {direction: up}\n",
        encoding="utf-8",
    )
    told = problems_of(path)
    assert len(told.splitlines()) == 5
    for place in ("contact.tension", "settings.colour", "scenario.direction", "positions[1]",
                  "settings.section"):  # fmt: skip
        assert place in told


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("settings: {seed: -1, section: [3, 99]}", ["settings.seed", "the line has 17 spans"]),
        (
            "supports: {clamp: 5 m, encumbrance: [1.2, 1.3], colour: red}",
            ["supports.clamp", "supports.colour", "has 2 values"],
        ),
        (
            "droppers: {mass: -1, positions: [60], presag: [0]}\nline: {ends: up}",
            ["droppers.mass", "outside the span of 55 m", "line.ends"],
        ),
        (
            "pantographs: [{name: a, stages: [{mass: 7, stiffness: 0, damping: -1}, "
            "{mass: 7, stiffness: 0}], static_force: 70, force_stage: 9}]",
            ["stages[1].damping", "stages[1].stiffness", "has 2 stages"],
        ),
    ],
)
def test_no_second_round(text: str, words: list[str], tmp_path: Path) -> None:
    """What faulty optional values and unknown keys used to hide is told at once."""
    path = tmp_path / "mine.yaml"
    path.write_text(HEAD + text + "\n", encoding="utf-8")
    told = problems_of(path)
    assert [word for word in words if word not in told] == [], told
    assert len(told.splitlines()) == len(words), told


def test_second_look_claims_nothing_false(tmp_path: Path) -> None:
    """A misspelt choice is told alone, without what would follow from the default in its place."""
    path = tmp_path / "mine.yaml"
    path.write_text(
        "schema: 1\ninclude: ac-simple\nname: a\n"
        "droppers: {mode: lenght, presag: null, lengths: [1, 1, 1, 1, 1, 1, 1, 1, 1]}\n",
        encoding="utf-8",
    )
    assert "did you mean 'length'" in problems_of(path)
    assert len(problems_of(path).splitlines()) == 1


def test_encumbrance_too_small(tmp_path: Path) -> None:
    """A messenger wire below the contact wire is one problem, and its cure works."""
    path = tmp_path / "mine.yaml"
    path.write_text(
        HEAD + "line: {spans: 3, span_length: 62 m}\nwires: {messenger: {tension: 9 kN}}\n"
        "droppers: {positions: [6, 18.5, 31, 43.5, 56], presag: [0, 0, 0, 0, 0]}\n"
        "supports: {encumbrance: 0.7 m}\nsettings: {section: [2, 2]}\n",
        encoding="utf-8",
    )
    (told,) = problems_of(path).splitlines()
    assert "supports.encumbrance: is too small: at dropper 3 of span 1 the messenger wire" in told
    found = re.search(r"give at least ([0-9.]+) m", told)
    assert found is not None
    cured = load_case(path, {"supports.encumbrance": f"{found.group(1)} m"})
    shape = find_shape(build(cured))
    assert 0.04 < shape.dropper_lengths.min() < 0.08
    expected = dropper_lengths(
        cured.line, cured.wires, cured.dropper_sets[0], cured.supports.encumbrances(4)[:2], 1
    )
    assert shape.dropper_lengths[5:10] == pytest.approx(expected, abs=0.015)


def test_names_with_a_slash(tmp_path: Path) -> None:
    """A line may be called as the trade calls it; the folder of its files is not."""
    case = load_case("ac-simple", ["name=B1/B2 3\\4"])
    assert case.name == "B1/B2 3\\4"
    assert default_folder(case.name).name == "tautwire-B1-B2-3-4"


def test_contact_stiffness_has_a_stated_default() -> None:
    """Without a contact stiffness that of EN 50318:2002 is used; sources and advice say so."""
    data = load_case("ac-simple").to_dict()
    del data["settings"]["contact_stiffness"]
    data["sources"] = []
    case = make_case(data)
    assert case.settings.contact_stiffness == 50e3
    assert case.settings.contact_stiffness == load_case("en50318-2002").settings.contact_stiffness
    assert [s.source for s in case.sources if s.path == "settings.contact_stiffness"] == [
        "Not given; the value of the reference model of EN 50318:2002 is used"
    ]
    assert [a.severity for a in preflight(case) if a.topic == "contact stiffness"] == ["warning"]
    given = make_case(data, {"settings.contact_stiffness": "50 kN/m"})
    assert not [a for a in preflight(given) if a.topic == "contact stiffness"]
    del data["settings"]
    assert make_case(data).settings.contact_stiffness == 50e3


def test_what_is_not_modelled_is_told_first(tmp_path: Path) -> None:
    """The feature that a line asks for goes before the faults that follow from it."""
    path = tmp_path / "mine.yaml"
    path.write_text("schema: 1\nname: rail\nline: {spans: 4}\nconductor_rail: 10 m\n")
    first, *others = problems_of(path).splitlines()
    assert "conductor_rail: not modelled yet: rigid overhead conductor rail" in first
    assert any("wires: is missing" in other for other in others)


def test_contradictions_are_found_beside_faults(tmp_path: Path) -> None:
    """A section outside the line is told although another part is invalid."""
    path = tmp_path / "mine.yaml"
    path.write_text(
        HEAD + "wires: {contact: {tension: 22 kg}}\nsettings: {section: [1, 99]}\n",
        encoding="utf-8",
    )
    assert "the line has 17 spans" in problems_of(path)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nothing.yaml", "there is no such file; check the path"),
        ("ac-simpel", "did you mean 'ac-simple'?; 'tautwire cases' lists the library"),
        ("zzz", "no such case in the library and no such file; 'tautwire cases' lists"),
        ("", "is a directory; give the path of a file in it"),
        ("a" * 300 + ".yaml", "cannot be read (File name too long)"),
        ("a\0b.yaml", "cannot be read"),
        ("benchmark-2015-pantograph", "is a pantograph, not a case; put 'include: benchmark"),
    ],
)
def test_no_such_file(
    name: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A name that leads to nothing is answered with the closest names."""
    monkeypatch.chdir(tmp_path)
    assert words in problems_of(name)


def test_neighbouring_file_is_suggested(tmp_path: Path) -> None:
    """A misspelt file name is answered with the file beside it."""
    (tmp_path / "my-line.yaml").write_text(HEAD, encoding="utf-8")
    assert "did you mean 'my-line.yaml'?" in problems_of(tmp_path / "my-lime.yaml")


def test_unreadable_neighbours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the folder cannot be listed, the message comes without a suggestion."""

    def refuse(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refuse)
    told = problems_of(tmp_path / "my-line.yaml")
    assert told.endswith("there is no such file; check the path")


def test_directory(tmp_path: Path) -> None:
    """A directory is no case, with a suffix or without."""
    (tmp_path / "folder.yaml").mkdir()
    assert "is a directory" in problems_of(tmp_path / "folder.yaml")
    assert "is a directory" in problems_of(tmp_path)


def test_huge_file(tmp_path: Path) -> None:
    """A file of 100 MB is refused without reading it; the message names size and limit."""
    path = tmp_path / "huge.yaml"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    assert "has 100.0 MB; at most 1 MB are read as a case file" in problems_of(path)


def test_alias_bomb(tmp_path: Path) -> None:
    """Aliases that multiply are refused before they are expanded."""
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12)]
    path = tmp_path / "bomb.yaml"
    path.write_text("\n".join(lines), encoding="utf-8")
    assert "its aliases expand to, more than 50000 values; write values out" in problems_of(path)


def test_too_many_values(tmp_path: Path) -> None:
    """A file of small size with very many values is refused early."""
    path = tmp_path / "many.yaml"
    path.write_text("a: [" + "1," * 51_000 + "1]\n", encoding="utf-8")
    assert "more than 50000 values" in problems_of(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"name: \xff\xfe\n", "is not UTF-8 text (byte 7); save it as UTF-8"),
        ("name: x\n".encode("utf-16"), "is not UTF-8 text (byte 1)"),
        (b"name: \0\n", "is a binary file; a text file is needed"),
    ],
)
def test_not_a_text(content: bytes, words: str, tmp_path: Path) -> None:
    """Binary content is refused with the encoding that is needed."""
    path = tmp_path / "binary.yaml"
    path.write_bytes(content)
    assert words in problems_of(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes exist on POSIX only")
def test_pipe(tmp_path: Path) -> None:
    """A named pipe is refused instead of waited for."""
    path = tmp_path / "pipe.yaml"
    os.mkfifo(path)
    assert "is not a regular file" in problems_of(path)


def test_no_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that may not be read is answered with the reason."""
    path = tmp_path / "locked.yaml"
    path.write_text(HEAD, encoding="utf-8")

    def refuse(*_: object) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    assert "cannot be read (Permission denied); change its permissions" in problems_of(path)


def test_endless_chain_of_includes(tmp_path: Path) -> None:
    """A long chain of files that include each other is cut."""
    for number in range(12):
        text = f"include: c{number + 1}.yaml\n"
        (tmp_path / f"c{number}.yaml").write_text(text, encoding="utf-8")
    told = problems_of(tmp_path / "c0.yaml")
    assert "8 of which each includes the next, are the limit" in told


def test_include_bomb(tmp_path: Path) -> None:
    """Files that multiply by inclusion are refused before they are all read."""
    for number in range(5):
        items = ", ".join([f"{{include: c{number + 1}.yaml}}"] * 10)
        text = f"name: a\nsections: [{items}]\n"
        (tmp_path / f"c{number}.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "c5.yaml").write_text("name: a\n", encoding="utf-8")
    assert "100 files in all" in problems_of(tmp_path / "c0.yaml")


def test_circle_by_another_path(tmp_path: Path) -> None:
    """A circle of includes is recognised when the paths differ."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "one.yaml").write_text("line: {include: two.yaml}\n", encoding="utf-8")
    (tmp_path / "two.yaml").write_text("include: sub/../one.yaml\n", encoding="utf-8")
    assert "two.yaml -> " in problems_of(tmp_path / "one.yaml")
