"""What does the contact stiffness change in the contact force?

Expect: below 5 Hz nothing (less than 5 %), between 5 and 20 Hz a lot: the head on a contact spring
of 50 kN/m resonates at 14 Hz, on one of 200 kN/m at 26 Hz. A short line, a coarse mesh and a step
of 2 ms keep this example quick; they are too coarse for figures to be quoted.
"""

import tautwire as tw

QUICK = {
    "line.spans": 9,
    "settings.nodes_between_droppers": 5,
    "settings.time_step": "2 ms",
    "scenario.uplift_force": "174 N",
}

deviations = {}
for stiffness in ("50 kN/m", "200 kN/m"):
    run = tw.run("ac-simple", overrides={**QUICK, "settings.contact_stiffness": stiffness})
    seen = tw.contact_statistics(run, tw.SharpLowpass()).pantograph("front").filtered["sharp"]
    deviations[stiffness] = seen.standard_deviations
    slow, fast = seen.standard_deviations["0_5"], seen.standard_deviations["5_20"]
    print(f"{stiffness:>9}: mean {seen.mean:6.1f} N, 0-5 Hz {slow:5.1f} N, 5-20 Hz {fast:5.1f} N")

soft, stiff = deviations["50 kN/m"], deviations["200 kN/m"]
assert abs(stiff["0_5"] / soft["0_5"] - 1.0) < 0.05
assert stiff["5_20"] < 0.9 * soft["5_20"]
