"""Quantities of the table of a study: name, unit and meaning. Data only."""

from __future__ import annotations

from dataclasses import dataclass

PANTOGRAPH, FILTER, BAND = "pantograph", "filter", "band"


@dataclass(frozen=True)
class Quantity:
    """One quantity of the table.

    Attributes
    ----------
    name : str
    unit : str
        ``"1"`` for a number without unit.
    text : str
    dimensions : tuple of str
        Beyond those of the study.
    """

    name: str
    unit: str
    text: str
    dimensions: tuple[str, ...] = ()


_FORCES = (
    ("mean", "mean contact force, low-passed at 20 Hz"),
    ("maximum", "largest contact force, low-passed at 20 Hz"),
    ("minimum", "smallest contact force, low-passed at 20 Hz"),
    ("statistical_maximum", "mean plus three standard deviations, 0-20 Hz"),
    ("statistical_minimum", "mean minus three standard deviations, 0-20 Hz"),
    ("std_advised", "standard deviation of the contact force up to the advised cut-off"),
)
STD = Quantity(
    "std",
    "N",
    "standard deviation of the contact force in a band",
    (PANTOGRAPH, FILTER, BAND),
)
PER_FILTER = tuple(Quantity(name, "N", text, (PANTOGRAPH, FILTER)) for name, text in _FORCES)
PER_PANTOGRAPH = (
    Quantity("uplift_force", "N", "applied uplift force", (PANTOGRAPH,)),
    Quantity("contact_height_range", "m", "range of the contact point's height", (PANTOGRAPH,)),
    Quantity("loss_count", "1", "number of contact losses", (PANTOGRAPH,)),
    Quantity("loss_percent", "%", "time without contact", (PANTOGRAPH,)),
    Quantity("loss_longest", "s", "longest contact loss", (PANTOGRAPH,)),
    Quantity("arc_percent", "%", "time in losses of at least 5 ms", (PANTOGRAPH,)),
)
PER_CASE = (
    Quantity("uplift_max", "m", "largest uplift at a support"),
    Quantity("dropper_force_max", "N", "largest dropper force"),
    Quantity("dropper_slack_longest", "s", "longest time that a dropper is slack"),
    Quantity("advised_cutoff", "Hz", "cut-off that covers a quarter of the shortest interval"),
    Quantity("carried_band", "Hz", "highest frequency that mesh and time step carry"),
    Quantity("steps", "1", "time steps of the last passage"),
    Quantity("tuning_passes", "1", "passages computed to tune the mean force"),
)
COST = (
    Quantity("cpu_s", "s", "processor time of the case"),
    Quantity("wall_s", "s", "time that the case took"),
    Quantity("peak_memory_mb", "MB", "largest memory its worker had used until then"),
)
TEXTS = {
    "status": "done, failed, refused (by validation) or missing",
    "reason": "why the case failed",
    "key": "what identifies the result: input, version, what is computed",
    "backend": "kernels that computed the case",
    "marked": "figures that mesh and time step do not carry",
    "warnings": "what to know before the numbers are used, such as what is outside the model",
}
KNOWN = (*PER_FILTER, STD, *PER_PANTOGRAPH, *PER_CASE)
ERROR = "_error"
"""End of the name of what tells the numerical error of the quantity before it."""
_WITH_ERROR = {*(name for name, _ in _FORCES), "std", "loss_percent", "uplift_max"}
ERRORS = tuple(
    Quantity(item.name + ERROR, item.unit, f"numerical error of: {item.text}", item.dimensions)
    for item in KNOWN
    if item.name in _WITH_ERROR
)
"""Of the quantities that have one, in tables of cases with ``settings.error``."""
NAMES = (*(item.name for item in (*KNOWN, *ERRORS, *COST)), PANTOGRAPH, FILTER, BAND)
"""Names that no axis may have."""
