"""The report in a browser, where one is installed."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tautwire.cli.app import run_command_line
from tautwire.report.pages.run_page import write_report
from tautwire.report.writers.html import script_hash

from .synthetic import make_case, make_elasticity, make_run

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
OPTIONS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--no-first-run"),
    *("--enable-logging=stderr", "--v=0", "--virtual-time-budget=20000", "--window-size=1300,2000"),
)
USE = """
const part = (name) => document.querySelector(`[data-part="${name}"]`);
const change = (name, value) => {
  part(name).value = value;
  part(name).dispatchEvent(new Event("input"));
};
part("play").click();
setTimeout(() => {
  part("play").click();
  change("length", "300"); change("exaggeration", "40");
  change("film", "1"); change("scrub", "600");
  document.querySelectorAll("button[data-range]").forEach((button) => button.click());
  window.dispatchEvent(new Event("beforeprint"));
  const charts = [...document.querySelectorAll(".chart")];
  console.log(`drawn ${charts.filter((c) => c.querySelector(".main-svg")).length}`);
  console.log(`requests ${performance.getEntriesByType("resource").length}`);
  console.log(`readout ${part("readout").textContent}`);
}, 3000);
"""
WIDTHS = """
addEventListener("load", () => setTimeout(() => {
  document.querySelectorAll("details").forEach((details) => { details.open = true; });
  window.dispatchEvent(new Event("beforeprint"));
  const { scrollWidth, clientWidth } = document.documentElement;
  console.log(`width ${clientWidth} needs ${scrollWidth}`);
}, 1000));
"""
TELEPHONE = """<!DOCTYPE html>
<iframe src="report.html" width="420" height="900" style="border: 0"></iframe>
"""
INJECTED = """
<script>console.log('a script ran')</script>
<img src="data:," onerror="console.log('a handler ran')">
"""


def _console(page: Path) -> list[str]:
    """Open a page and return what it wrote to the console."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        pytest.skip("no browser is installed")
    command = [browser, *OPTIONS, f"--user-data-dir={page.parent / 'profile'}", "--dump-dom"]
    done = subprocess.run(
        [*command, page.as_uri()], capture_output=True, text=True, timeout=180, check=False
    )
    return re.findall(r'CONSOLE[:(]\d+[^"]*"(.*)", source:', done.stderr)


def _used(text: str, script: str) -> str:
    """Append a script to a page, allowed by its policy."""
    allowed = text.replace("script-src", f"script-src {script_hash(script)}", 1)
    return f"{allowed}<script>{script}</script>"


@pytest.mark.slow
def test_page_works_in_a_browser(tmp_path: Path) -> None:
    """All figures are drawn, all controls work, nothing is requested, the console stays silent."""
    first, second = make_case(spans=8), make_case(spans=8, pantographs=2)
    runs = [make_run(first, losses=True), make_run(second)]
    page = write_report(runs, tmp_path / "report.html", make_elasticity(first))
    page.write_text(_used(page.read_text(encoding="utf-8"), USE), encoding="utf-8")
    messages = dict(line.split(" ", 1) for line in _console(page))
    assert set(messages) == {"drawn", "requests", "readout"}, messages
    assert messages["drawn"] == "10"
    assert messages["requests"] == "0"
    assert "front: span" in messages["readout"]


@pytest.mark.slow
def test_injected_scripts_do_not_run(tmp_path: Path) -> None:
    """Script and handler that stand in the page without a hash are refused by the browser."""
    page = write_report([make_run(make_case(spans=3))], tmp_path / "report.html")
    text = page.read_text(encoding="utf-8") + INJECTED
    page.write_text(_used(text, "console.log('the end');"), encoding="utf-8")
    told = "\n".join(_console(page))
    assert "the end" in told
    assert " ran" not in told
    assert told.count("violates the following Content Security Policy directive") == 2


@pytest.mark.slow
def test_page_fits_a_telephone(tmp_path: Path) -> None:
    """At 420 pixels nothing but tables within their frames is wider than the screen."""
    first, second = make_case(spans=8), make_case(spans=8, pantographs=2)
    runs = [make_run(first, losses=True), make_run(second)]
    page = write_report(runs, tmp_path / "report.html", make_elasticity(first))
    _check_width(page)


@pytest.mark.slow
def test_static_page_fits_a_telephone(tmp_path: Path) -> None:
    """The page of the static line with its workshop sheet is no wider than 420 pixels either."""
    code = run_command_line(
        ["static", "ac-simple", "--set", "line.spans=6", "--set", "settings.section=null",
         "--set", "settings.nodes_between_droppers=4", "--out", str(tmp_path)]
    )  # fmt: skip
    assert code == 0
    page = tmp_path / "report.html"
    (tmp_path / "static.html").rename(page)
    _check_width(page)


def _check_width(page: Path) -> None:
    """Check that a page named report.html is as wide as a telephone, all its tables open."""
    page.write_text(_used(page.read_text(encoding="utf-8"), WIDTHS), encoding="utf-8")
    frame = page.with_name("telephone.html")
    frame.write_text(TELEPHONE, encoding="utf-8")
    told = [re.match(r"width (\d+) needs (\d+)", line) for line in _console(frame)]
    assert len(told) == 1
    assert told[0]
    assert 400 <= int(told[0][1]) <= 420
    assert int(told[0][2]) == int(told[0][1])
