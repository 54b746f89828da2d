"""What does a line of one's own need, from its tables to a report that can be sent?

Expect: five files (the case, tables of supports and droppers, the office's block, limits of the
railway), droppers from 0.74 to 1.25 m, none of them slack, arms that carry none of the wire, a
largest uplift of 35 to 55 mm and every limit kept, with the name of who checked it.
"""

from pathlib import Path

import numpy as np

import tautwire as tw
from tautwire.assessment.checks import checks

FILES = Path(__file__).parent / "own-line"

case = tw.load_case(FILES / "valley.yaml")
assert case.project.client == "Valley Railway"

# 1. the line at rest: what the workshop cuts
model = tw.build(case)
shape = tw.find_shape(model)
lengths, forces = shape.dropper_lengths_unstrained, shape.dropper_forces
print(f"{lengths.size} droppers of {lengths.min():.3f} to {lengths.max():.3f} m")
assert 0.74 < lengths.min() < lengths.max() < 1.25
assert forces.min() > 10.0
arms = case.supports.arm
carried = shape.arm_forces * np.sin(shape.arm_angles) - 0.5 * 9.81 * arms.mass * arms.length
assert np.abs(carried).max() < 1.0

# 2. the passage, its mean force tuned to that of the case
run = tw.run(case)
found = tw.contact_statistics(run)
front = found.pantograph("front").headline
print(f"mean {front.mean:.1f} N, standard deviation {front.standard_deviation:.1f} N")
print(f"largest uplift {1e3 * found.uplift.maximum:.1f} mm")
assert abs(front.mean - 102.03) < 0.5
assert 0.035 < found.uplift.maximum < 0.055

# 3. the limits that the case names, as the client reads them
for check in checks(found, case):
    print(f"{check.name}: {check.words}, checked by {check.checked_by} on {check.checked_on}")
    assert check.words == "within"

# 4. the report, one file
page = tw.write_report(run, "valley.html")
text = page.read_text(encoding="utf-8")
assert "B. Checker" in text
assert page.stat().st_size < 3_000_000
