"""Pictures of the documentation: shown, small, and true."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
LARGEST = 100_000
"""Bytes of a picture that is kept with the source."""


def _module() -> ModuleType:
    spec = importlib.util.spec_from_file_location("sketches", DOCS / "_ext" / "sketches.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


SKETCHES = _module().SKETCHES


def _labels(picture: str) -> list[str]:
    return re.findall(r"<text[^>]*>([^<]*)</text>", picture)


def test_pictures_are_shown_and_small() -> None:
    """Every picture stands on a page, every page finds its pictures, and none is large."""
    pages = [path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")]
    shown = {name for page in pages for name in re.findall(r"\(pictures/([\w-]+\.svg)\)", page)}
    kept = {path.name for path in (DOCS / "pictures").iterdir()}
    assert shown == kept
    assert all(path.stat().st_size <= LARGEST for path in (DOCS / "pictures").iterdir())


@pytest.mark.parametrize("name", list(SKETCHES))
def test_numbers_of_a_sketch_are_those_of_today(name: str) -> None:
    """Lengths, heights and forces written in a sketch are those that the line has now."""
    kept = (DOCS / "pictures" / f"{name}.svg").read_text(encoding="utf-8")
    assert _labels(SKETCHES[name]().svg()) == _labels(kept)


def test_sketches_show_what_was_asked_for() -> None:
    """Encumbrance, pre-sag, SD, DD, stagger and lift have the values of the reference line."""
    span, plan, closed = (
        _labels((DOCS / "pictures" / f"{name}.svg").read_text(encoding="utf-8"))
        for name in ("span", "stagger", "closure")
    )
    for text in ("encumbrance 1.20 m", "pre-sag 55 mm", "SD 4.50 m", "DD 5.75 m", "span 55 m"):
        assert text in span
    assert plan.count("stagger +200 mm") == 1
    assert plan.count("stagger \N{MINUS SIGN}200 mm") == 2
    assert "carries 0.0 N of the wire" in closed
