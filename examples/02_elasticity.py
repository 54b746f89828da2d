"""How soft is AC simple, and where?

Expect: 0.20 mm/N at a support, 0.16 at the first dropper, 0.39 at mid-span, within 4 % of the mean
of the ten codes of the 2015 benchmark. Holding the messenger wire along the track makes the middle
of a span about 10 % stiffer.
"""

import numpy as np

import tautwire as tw

BENCHMARK = np.array([0.206, 0.165, 0.273, 0.345, 0.388, 0.400])
ONE_SPAN = {"settings.section": [9, 9]}


def half_span(**changes: object) -> np.ndarray:
    """Return the elasticity at the support and at droppers 1 to 5 of span 9 [mm/N]."""
    case = tw.load_case("ac-simple", ONE_SPAN | changes)
    model = tw.build(case)
    found = tw.elasticity(model, tw.find_shape(model), force=100.0)
    chosen = [kind != "middle" for kind in found.kind]
    return 1e3 * found.elasticity[chosen][:6]


free = half_span()
fixed = half_span(**{"supports.messenger_longitudinal": "fixed"})

print("                     support and droppers 1 to 5 [mm/N]")
for name, values in {"benchmark mean": BENCHMARK, "free": free, "fixed": fixed}.items():
    print(f"{name:>18}" + "".join(f"{value:8.3f}" for value in values))

assert np.abs(free / BENCHMARK - 1.0).max() < 0.04
assert 0.08 < 1.0 - fixed[-1] / free[-1] < 0.12
