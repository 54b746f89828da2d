"""Fixtures shared by all tests: one BLAS thread, and the rows of the validation table."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest

VALIDATION_FILE = Path("build") / "validation.json"
_rows = pytest.StashKey[list[dict[str, Any]]]()


def _span(
    target: float | None,
    relative: float | None,
    absolute: float | None,
    allowed: tuple[float, float] | None,
) -> tuple[float, float]:
    """Return the interval in which a value counts as inside."""
    if allowed is not None:
        return allowed
    if target is None or (relative is None) == (absolute is None):
        raise ValueError("give `allowed`, or `target` with either `relative` or `absolute`")
    width = absolute if absolute is not None else (relative or 0.0) * abs(target)
    return target - width, target + width


def _tolerance(
    relative: float | None, absolute: float | None, allowed: tuple[float, float] | None
) -> str:
    """Say the tolerance as the table shows it."""
    if allowed is not None:
        return f"{allowed[0]:g} to {allowed[1]:g}"
    return f"± {100 * relative:g} %" if relative is not None else f"± {absolute:g}"


@pytest.fixture(autouse=True)
def _figures_are_what_plotly_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the package plotly check every key of every figure that a test puts on a page."""
    from tautwire.report.drawing import Drawing

    written = Drawing.to_json

    def checked(drawing: Drawing) -> str:
        drawing.to_figure()
        return written(drawing)

    monkeypatch.setattr(Drawing, "to_json", checked)


@pytest.fixture
def record_validation(request: pytest.FixtureRequest) -> Callable[..., bool]:
    """Compare a number with its source and store the row of the validation table.

    The returned function gives True where the number lies inside, so a test reads
    ``assert record_validation("AC simple, 320 km/h", "σ(0-20 Hz)", ours=..., unit="N",
    target=53.91, relative=0.03, source="world benchmark 2015, mean")``. A miss that is known and
    explained is stored with ``note`` and asserted by its own number.
    """
    rows = request.config.stash[_rows]

    def record(
        case: str,
        quantity: str,
        *,
        ours: float,
        unit: str,
        source: str,
        target: float | None = None,
        relative: float | None = None,
        absolute: float | None = None,
        allowed: tuple[float, float] | None = None,
        note: str = "",
    ) -> bool:
        low, high = _span(target, relative, absolute, allowed)
        inside = low <= ours <= high
        rows.append(
            {
                "case": case,
                "quantity": quantity,
                "unit": unit,
                "ours": float(f"{ours:.6g}"),
                "target": None if target is None else float(f"{target:.6g}"),
                "tolerance": _tolerance(relative, absolute, allowed),
                "source": source,
                "verdict": "inside" if inside else "outside",
                "note": note,
            }
        )
        return inside

    return record


def pytest_configure(config: pytest.Config) -> None:
    """Start with an empty table."""
    config.stash[_rows] = []


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any, error: object) -> None:
    """Collect the rows of a worker process of pytest-xdist."""
    node.config.stash[_rows].extend(getattr(node, "workeroutput", {}).get("validation", []))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the table, or hand the rows to the main process."""
    rows = session.config.stash[_rows]
    workeroutput = getattr(session.config, "workeroutput", None)
    if workeroutput is not None:
        workeroutput["validation"] = rows
    elif rows:
        path = session.config.rootpath / VALIDATION_FILE
        path.parent.mkdir(exist_ok=True)
        ordered = sorted(rows, key=lambda row: (row["case"], row["quantity"], row["source"]))
        text = json.dumps(ordered, indent=1, ensure_ascii=False)
        path.write_text(text + "\n", encoding="utf-8")
