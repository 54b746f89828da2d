"""Does a run agree with what a measuring train wrote?

The recording is made of the run itself: two sensors with noise, an odometer that starts 4 m off and
drifts by 0.2 %, kilometres, decimal commas, headings in German. Expect: columns known without a
mapping, positions found within 0.2 m, standard deviations that agree within 0.5 %.
"""

from pathlib import Path

import numpy as np

import tautwire as tw

SPANS = [55.0, 50.0, 60.0, 45.0, 55.0, 60.0, 50.0, 55.0]
DROPPERS = [np.linspace(4.5, span - 4.5, round(span / 9.0)).tolist() for span in SPANS]
case = tw.load_case(
    "ac-simple",
    {
        "line.spans": len(SPANS),
        "line.span_length": SPANS,
        "droppers.positions": DROPPERS,
        "droppers.presag": [[0.0] * len(row) for row in DROPPERS],
        "settings.section": [2, 7],
        "settings.nodes_between_droppers": 5,
        "scenario.speed": "200 km/h",
        "scenario.uplift_force": "90 N",
    },
)
model = tw.build(case)
run = tw.simulate(model, tw.find_shape(model))
force = run.contact_force("front")

rng = np.random.default_rng(1)
left, right = (0.5 * force.force + rng.normal(0.0, 1.0, len(force.force)) for _ in range(2))
place = 4.0 + 1.002 * force.position
columns = zip(force.time, place / 1e3, left, right, strict=True)
rows = [f"{t:.3f};{x:.6f};{a:.2f};{b:.2f}" for t, x, a, b in columns]
text = "\n".join(["Zeit [s];Weg [km];Kraft links [N];Kraft rechts [N]", *rows])
Path("train.csv").write_text(text.replace(".", ","), encoding="utf-8")

recording = tw.load_recording("train.csv")
found = tw.compare_with_measurement(run, recording)
print(found.placement.text)
for row in found.rows:
    print(f"{row.quantity:20} {row.simulated:8.3f} {row.measured:8.3f}")

true = np.interp(recording.time, force.time, force.position)
assert np.abs(found.placement.rows - true).max() < 0.2
deviation = next(row for row in found.rows if row.quantity == "standard_deviation")
assert abs(deviation.relative_difference) < 0.005
assert not found.missed
