"""How much does a second pantograph suffer from the first?

Expect: 100 m behind the first one, at 320 km/h, the second one's contact force varies more. A short
line, a coarse mesh and a step of 2 ms keep this example quick; they are too coarse for figures to
be quoted.
"""

import tautwire as tw

QUICK = {
    "line.spans": 12,
    "settings.nodes_between_droppers": 5,
    "settings.time_step": "2 ms",
    "settings.section": [4, 8],
    "scenario.uplift_force": "174 N",
    "pantographs[2].behind": "100 m",
}

run = tw.run("ac-simple-two-pantographs", overrides=QUICK)
statistics = tw.contact_statistics(run, tw.SharpLowpass())

deviations = []
for pantograph in statistics.pantographs:
    seen = pantograph.filtered["sharp"]
    deviations.append(seen.standard_deviation)
    print(f"{pantograph.name}: {seen.mean:.1f} N ± {seen.standard_deviation:.1f} N")

front, rear = deviations
assert rear > front
