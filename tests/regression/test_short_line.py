"""Numbers of a short line, kept so that an unintended change of any of them is seen.

They are no reference: right or wrong, they are what the program gave. Regenerate them with
``python -m tests.regression.test_short_line`` from the root of the checkout and review the diff.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import tautwire as tw

GOLDEN = Path(__file__).with_name("short_line.json")
LINE = {
    "line.spans": 5,
    "settings.section": [2, 3],
    "settings.nodes_between_droppers": 5,
    "scenario.uplift_force": "150 N",
    "supports.arm.motion": "swinging",
}


def numbers(backend: str) -> dict[str, Any]:
    """Return inner values of shape, elasticity and passage of the short line."""
    case = tw.load_case("ac-simple-plane", LINE)
    model = tw.build(case)
    shape = tw.find_shape(model)
    run = tw.simulate(model, shape, backend=backend)
    force = run.contact_force("front").force
    sharp = tw.contact_statistics(run).pantograph().sharp
    return {
        "dropper_lengths_m": shape.dropper_lengths_unstrained[:9].tolist(),
        "dropper_forces_n": shape.dropper_forces[9:18].tolist(),
        "arm_forces_n": shape.arm_forces.tolist(),
        "elasticity_m_per_n": tw.elasticity(model, shape).elasticity[:9].tolist(),
        "contact_force_n": force[199::400].tolist(),
        "standard_deviations_n": dict(sharp.standard_deviations),
    }


@pytest.mark.parametrize("backend", ["auto", "reference"])
def test_short_line(backend: str) -> None:
    """Statics agree to 1e-7, the passage to the tolerance of its iteration, on every backend."""
    golden, ours = json.loads(GOLDEN.read_text(encoding="utf-8")), numbers(backend)
    for name in ("dropper_lengths_m", "dropper_forces_n", "arm_forces_n", "elasticity_m_per_n"):
        assert ours[name] == pytest.approx(golden[name], rel=1e-7), name
    assert ours["contact_force_n"] == pytest.approx(golden["contact_force_n"], abs=0.3)
    for band, value in golden["standard_deviations_n"].items():
        assert ours["standard_deviations_n"][band] == pytest.approx(value, abs=0.02), band


if __name__ == "__main__":
    GOLDEN.write_text(json.dumps(numbers("reference"), indent=1) + "\n", encoding="utf-8")
