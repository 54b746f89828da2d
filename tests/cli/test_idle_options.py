"""Options that would do nothing are refused by name, before any work."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from .conftest import Invoke, Outcome

FORCE = "time [s],position [m],force [N]\n" + "".join(
    f"{n / 200},{n / 4},{100 + 10 * np.sin(n / 9):.3f}\n" for n in range(1200)
)
HEIGHT = "time [s],position [m],height [m]\n" + "".join(
    f"{n / 200},{n / 4},5.3\n" for n in range(1200)
)


def refusal(invoke: Invoke, *arguments: object) -> str:
    """Return what is said of arguments that are refused."""
    told = invoke(*arguments)
    assert told.code == 2, told.out + told.err
    return told.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("static", "ac-simple", "--pdf"), "--pdf needs --out DIR"),
        (("static", "ac-simple", "--project", "p.yaml"), "--project needs --out DIR"),
        (("modes", "ac-simple", "--project", "p.yaml"), "--project needs --out DIR"),
        (("cases", "ac-simple", "--force"), "--force needs --copy FILE"),
        (("catalogue", "AC-100", "--force"), "--force needs --copy FILE"),
        (("catalogue", "AC-100", "--kind", "rope", "--copy", "a.yaml"), "--kind needs a list"),
        (("limits", "--force"), "--force needs --copy FILE"),
        (("limits", "--limits", "a.yaml", "--copy", "b.yaml"), "--limits needs no --copy"),
        (("reproduce", "en50318-2002", "--quick"), "--quick needs the study song2021"),
        (("reproduce", "en50318-2002", "--workers", "2"), "--workers needs the study song2021"),
        (("draw", "ac-simple", "-o", "a.dxf", "--paper", "A1"), "--paper needs a file in .svg"),
        (("compare", "run.nc", "a.csv", "--elasticity-force", "100 N"), "--elasticity-force needs"),
        (("compare", "run.nc", "a.csv", "--project", "p.yaml"), "--project needs --out DIR"),
        (("compare", "run.nc", "a.csv", "--reversed"), "--reversed needs --air"),
        (("measured", "a.csv", "--reversed"), "--reversed needs --air"),
        (
            ("run", "ac-simple", "--accurate", "--set", "settings.integrator.method=hht"),
            "--accurate sets settings.integrator, as --set 'settings.integrator.method=hht' does",
        ),
        (
            ("run", "ac-simple", "--error", "bound", "--set", "settings.error=none"),
            "--error sets settings.error, as --set 'settings.error=none' does; give one of the two",
        ),
        (
            ("static", "ac-simple", "--condition", "design", "--set", "condition=ice"),
            "--condition sets condition",
        ),
    ],
)
def test_refused_by_name(arguments: tuple[str, ...], words: str, invoke: Invoke) -> None:
    """Nothing is computed, no file is opened: the option and what it needs are named."""
    assert words in refusal(invoke, *arguments)


def test_options_for_channels_that_were_not_recorded(invoke: Invoke, tmp_path: Path) -> None:
    """Limits and corrections of channels that the file lacks are refused together; what the file
    has they work on."""
    (tmp_path / "force.csv").write_text(FORCE, encoding="utf-8")
    (tmp_path / "height.csv").write_text(HEIGHT, encoding="utf-8")
    told = refusal(invoke, "measured", tmp_path / "force.csv", "--hard", "300")
    assert "--hard needs accelerometers of the head" in told
    told = refusal(invoke, "measured", tmp_path / "force.csv", "--speed", "200 km/h")
    assert "--speed needs a file without time and speed" in told
    options = ("--high", "200 N", "--filtered", "--every", "100 m", "--strip-mass", "3 kg")
    told = refusal(invoke, "measured", tmp_path / "height.csv", *options)
    for option in ("--high", "--filtered", "--every", "--strip-mass"):
        assert f"{option} needs a contact force" in told
    assert invoke("measured", tmp_path / "height.csv").code == 0
    high = invoke("measured", tmp_path / "force.csv", "--high", "105 N", "--every", "100 m")
    assert high.code == 0, high.err


def test_compare_without_what_options_are_for(
    short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path
) -> None:
    """Options for recordings need one, with a force where they are of the force; the force of the
    elasticity needs points with some."""
    run = short_run[0] / "run.nc"
    points = tmp_path / "points.csv"
    points.write_text("support,uplift [mm]\n4,60\n", encoding="utf-8")
    options = (
        "--pantograph",
        "nope",
        "--offset",
        "5 km",
        "--air",
        "air.csv",
        "--mapping",
        "m.yaml",
    )
    (tmp_path / "air.csv").write_text("speed [km/h],force [N]\n0,0\n300,9\n", encoding="utf-8")
    told = refusal(invoke, "compare", run, "--points", points, *options)
    for option in ("--pantograph", "--offset", "--air", "--mapping"):
        assert f"{option} needs a recording beside the runs" in told
    told = refusal(invoke, "compare", run, "--points", points, "--elasticity-force", "100 N")
    assert "--elasticity-force needs elasticity to be compared" in told
    (tmp_path / "height.csv").write_text(HEIGHT, encoding="utf-8")
    told = refusal(invoke, "compare", run, tmp_path / "height.csv", "--pantograph", "nope")
    assert "--pantograph needs a contact force; no recording has one" in told
    assert invoke("compare", run, "--points", points).code == 0
