"""How long is contact lost, and does the time step decide it?

Expect: on a line with a rough running surface a constant step of 1 ms is wrong about the durations
of the losses by more than a tenth where its samples are counted, by less where they are
interpolated; the adaptive step by less than a twentieth. A short line
and a coarse mesh keep this example quick; they are too coarse for figures to be quoted.
"""

import tautwire as tw

ROUGH = {
    "line.spans": 8,
    "settings.nodes_between_droppers": 4,
    "settings.seed": 1,
    "scenario.uplift_force": "174 N",
    "irregularities.unevenness": [{"kind": "uniform", "spacing": "1 m", "amplitude": "1.8 mm"}],
}

model = tw.build(tw.load_case("ac-simple", ROUGH))
shape = tw.find_shape(model)
coarse = tw.simulate(model, shape, stepping=tw.ConstantStep(1e-3))
adaptive = tw.simulate(model, shape, stepping=tw.AdaptiveStep(1e-3))
fine = tw.simulate(model, shape, stepping=tw.ConstantStep(0.1e-3))

comparison = tw.compare_losses(
    {
        "1 ms, counted": tw.contact_loss(coarse, counted=True)[0],
        "1 ms": coarse,
        "adaptive": adaptive,
        "0.1 ms": fine,
    }
)
print(comparison)

counted, interpolated, refined = comparison.matches
for match in comparison.matches:
    print(f"{match.label}: median error {100 * match.median_error:.1f} %")

assert not refined.missed
assert not refined.spurious
assert refined.median_error < 0.05
assert counted.median_error > 0.1
assert 0.03 < interpolated.median_error < counted.median_error
