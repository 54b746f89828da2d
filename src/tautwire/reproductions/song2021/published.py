"""Numbers printed in the paper; figures carry no further ones."""

from __future__ import annotations

TITLE = (
    "Assessment of the high-frequency response in railway pantograph-catenary interaction based "
    "on numerical simulation"
)
SOURCE = (
    "Y. Song, A. Rønnquist, P. Nåvik: Assessment of the High-frequency Response in Railway "
    "Pantograph-Catenary Interaction Based on Numerical Simulation, 2021"
)
FILTER = "low-pass at 20 Hz or as stated; type and order are not stated"

PRESAG = (0.0, 24.0, 41.0, 52.0, 55.0, 52.0, 41.0, 24.0, 0.0)
"""Table 1: pre-sag at the droppers [mm]."""

ELASTICITY_BENCHMARK = (0.206, 0.165, 0.273, 0.345, 0.388, 0.400)
"""Table 1: support and droppers 1 to 5, mean of the benchmark [mm/N]."""

ELASTICITY_PAPER = (0.19257, 0.15647, 0.26774, 0.32680, 0.36832, 0.37509)
"""Table 1: support and droppers 1 to 5, the paper's model [mm/N]."""

LARGEST_ELASTICITY_ERROR = 6.52
"""Table 1: largest deviation of the paper's model from the benchmark [%]."""

ACCEPTED_ELASTICITY_ERROR = 10.0
"""Section II.C: threshold of the static validation [%]."""

QUANTITIES: tuple[str, ...] = (
    "mean",
    "std_0_20",
    "std_0_2",
    "std_0_5",
    "std_5_20",
    "maximum",
    "minimum",
)
NAMES = {
    "mean": "Fm",
    "std_0_20": "σ (0–20 Hz)",
    "std_0_2": "σ (0–2 Hz)",
    "std_0_5": "σ (0–5 Hz)",
    "std_5_20": "σ (5–20 Hz)",
    "maximum": "Fmax",
    "minimum": "Fmin",
}
BENCHMARK: dict[str, float] = dict(
    zip(QUANTITIES, (169.0, 53.91, 38.27, 41.04, 34.80, 313.22, 60.40), strict=True)
)
"""Table 2: mean of the benchmark [N]."""

PAPER: dict[str, float] = dict(
    zip(QUANTITIES, (169.15, 52.59, 38.25, 41.00, 32.99, 305.85, 56.22), strict=True)
)
"""Table 2: the paper's model [N]."""

ELEMENT_PASSING = {
    9: (123.67, 158.02),
    12: (170.05, 217.28),
    15: (216.43, 276.54),
    18: (262.80, 335.80),
}
"""Section III.A: frequencies v/Le by NAD [Hz]."""

HALF_ELEMENT = 250.0
"""Section III.A: 'a significant peak at around 250 Hz with NAD = 9', n = 2 [Hz]."""

STIFFNESS_CHANGES = {20: -11.94, 50: -6.08, 200: 16.67}
"""Section III.B: change of the standard deviation from 50 to 500 kN/m, by cut-off [Hz] [%].

The text gives sizes; the directions are those it describes.
"""

REGIONS = {"DD": 5.75, "SD": 4.25, "DD/2": 2.88, "SD/2": 2.12, "DD/4": 1.44, "SD/4": 1.13}
"""Section IV.A: wavelengths of the six regions [m]."""

CUTOFF_WAVENUMBER = 0.9
"""Section IV.C [1/m]."""

CUTOFFS = {200: 50.0, 225: 56.25, 250: 62.5, 275: 68.75, 320: 80.0}
"""Section IV.C: suggested cut-off by speed [km/h] [Hz]."""

LOSS_CONSTANT_1 = (
    None, None, 3.00, 2.00, 22.00, 5.99, 18.00, 7.99, 4.00, 6.99, 2.00, 6.99, 1.00, 2.00, None,
    None,
)  # fmt: skip
# Table 3 (see below).
LOSS_CONSTANT_5 = (
    2.25, 1.25, 4.10, 3.35, 23.71, 7.39, 19.54, 7.10, 5.06, 6.08, 1.44, 4.03, 1.59, 3.53, 1.67,
    2.36,
)  # fmt: skip
LOSS_VARIABLE = (
    None, None, 4.14, 3.32, 23.68, 7.33, 19.37, 6.99, 5.19, 6.10, 1.42, 3.98, 1.53, 3.58, 1.41,
    2.00,
)  # fmt: skip
"""Table 3: durations of the losses by constant step 1 ms and 0.2 ms and by variable step [ms]."""

LARGEST_ERROR_CONSTANT_1, LARGEST_ERROR_CONSTANT_5 = 75.63, 20.0
"""Section V: errors with respect to the variable step: of 1 ms, and limit for 0.2 ms [%]."""
