"""Layout of result files: dimensions, units and meaning of every variable.

Data only; :mod:`tautwire.results.storage` writes and reads by it. A change that an older program
would misread raises :data:`FORMAT_VERSION`.
"""

from __future__ import annotations

from dataclasses import dataclass

FORMAT = "tautwire results"
FORMAT_VERSION = 2


@dataclass(frozen=True)
class Entry:
    """One variable of a file.

    Attributes
    ----------
    name : str
        Name in the file.
    source : str
        Attribute of the result object.
    dimensions : tuple of str
    units : str
        ``"1"`` for a number without unit.
    text : str
        What it is (``long_name``).
    kind : str
        ``"number"``, ``"count"`` (whole numbers) or ``"text"``.
    """

    name: str
    source: str
    dimensions: tuple[str, ...]
    units: str
    text: str
    kind: str = "number"


KINDS = {"number": "fiu", "count": "iu", "text": "OSU"}
"""Types of data (as NumPy's letters) that a kind of variable may have."""

TIME = Entry("time", "time", ("time",), "s", "time since the start")
NAMES = Entry("pantograph", "name", ("pantograph",), "1", "name of the pantograph", "text")
STAGE_COUNT = Entry(
    "stage_count", "", ("pantograph",), "1", "number of stages of the pantograph", "count"
)

POINTS = {"support", "dropper", "middle"}
"""Kinds of points of the elasticity."""

NUMBERS = {
    *("dof", "steps", "iterations_mean", "refactorisations", "full_newton_steps"),
    *("simulated_s", "cpu_s", "wall_s", "real_time_factor", "tuning_passes"),
    *("windows", "refined_s", "unsettled_windows"),
}
"""Counters that are counted with."""


RUN = (
    Entry(
        "support_uplift",
        "support_uplift",
        ("time", "support"),
        "m",
        "vertical displacement of the contact wire at the support from the static state",
    ),
)

DROPPERS = (
    Entry(
        "dropper_force",
        "force",
        ("dropper_sample", "dropper"),
        "N",
        "axial dropper force, tension positive, zero while slack, from the sample dropper_first on",
    ),
    Entry(
        "dropper_first",
        "first",
        ("dropper",),
        "1",
        "sample of the first force of the dropper, from 0; the time step counts samples",
        "count",
    ),
    Entry(
        "dropper_least", "least", ("dropper",), "N", "least force where dropper_force keeps none"
    ),
    Entry(
        "dropper_largest",
        "largest",
        ("dropper",),
        "N",
        "largest force where dropper_force keeps none",
    ),
    Entry(
        "dropper_slack_time",
        "slack_time",
        ("dropper",),
        "s",
        "time without force where dropper_force keeps none",
    ),
)

PANTOGRAPH = (
    Entry("position", "position", ("pantograph", "time"), "m", "position along the track"),
    Entry(
        "contact_force",
        "contact_force",
        ("pantograph", "time"),
        "N",
        "unfiltered contact force, positive when the pantograph lifts the wire",
    ),
    Entry(
        "gap",
        "gap",
        ("pantograph", "time"),
        "m",
        "height of the contact wire above the head, negative in contact",
    ),
    Entry(
        "wire_height",
        "wire_height",
        ("pantograph", "time"),
        "m",
        "height of the contact wire at the pantograph",
    ),
    Entry(
        "wire_force",
        "wire_forces",
        ("pantograph", "time", "contact_wire"),
        "N",
        "share of each contact wire in the contact force, NaN where the head does not reach it",
    ),
    Entry(
        "stage_height",
        "stage_heights",
        ("pantograph", "time", "stage"),
        "m",
        "displacement of the pantograph stage from its start, head first",
    ),
    Entry(
        "active",
        "active",
        ("pantograph", "time"),
        "1",
        "1 once the pantograph has entered the line, 0 before",
        "count",
    ),
)

PANTOGRAPH_SCALARS = (
    Entry("uplift_force", "uplift_force", ("pantograph",), "N", "applied uplift force"),
    Entry(
        "target_mean",
        "target_mean",
        ("pantograph",),
        "N",
        "mean contact force the uplift force was tuned to, NaN when it was prescribed",
    ),
)

SNAPSHOTS = (
    Entry("time", "time", ("time",), "s", "time since the start"),
    Entry("x", "x", ("point",), "m", "position along the track"),
    Entry("wire", "wire", ("point",), "1", "number of the wire of the point, from 0", "count"),
    Entry("z", "z", ("time", "point"), "m", "height of the wire"),
)

EVENTS = (
    Entry("time", "time", ("event",), "s", "instant at which a contact opens or closes"),
    Entry("pantograph", "pantograph", ("event",), "1", "number of the pantograph, from 1", "count"),
    Entry("opens", "opens", ("event",), "1", "1 for a separation, 0 for a re-contact", "count"),
)

IRREGULARITIES = (
    Entry("seed", "seed", (), "1", "seed of everything random", "count"),
    Entry(
        "dropper_height",
        "dropper_height",
        ("dropper",),
        "m",
        "installation error of the height of the contact wire at the dropper, positive up",
    ),
    Entry(
        "dropper_length",
        "dropper_length",
        ("dropper",),
        "m",
        "installation error of the dropper length",
    ),
    Entry("surface_start", "surface_start", (), "m", "position of the first ordinate"),
    Entry("surface_spacing", "surface_spacing", (), "m", "distance of the ordinates"),
    Entry(
        "surface_height",
        "surface_height",
        ("ordinate",),
        "m",
        "height of the running surface relative to the wire, positive up",
    ),
)

ELASTICITY = (
    Entry("span", "span", ("point",), "1", "number of the span, from 1", "count"),
    Entry("kind", "kind", ("point",), "1", "support, dropper or middle (between two)", "text"),
    Entry(
        "index", "index", ("point",), "1", "number of the dropper (a middle: on its left)", "count"
    ),
    Entry("x", "x", ("point",), "m", "position along the track"),
    Entry("elasticity", "elasticity", ("point",), "m N-1", "static uplift per vertical force"),
    Entry("force", "force", (), "N", "vertical force at which it was evaluated"),
)

EQUILIBRIUM = (
    Entry("position", "position", ("dof",), "m", "nodal coordinates and slopes, node by node"),
    Entry(
        "cable_length", "cable_lengths", ("element",), "m", "unstrained length of a wire element"
    ),
    Entry("node_s", "node_s", ("node",), "m", "place of the node along the track"),
    Entry(
        "node_wire",
        "node_wire",
        ("node",),
        "1",
        "number of the wire of the node, from 0; -1 for the elastic far end of an arm",
        "count",
    ),
    Entry("wire_name", "wire_names", ("wire",), "1", "name of the wire", "text"),
    Entry(
        "wire_role",
        "wire_roles",
        ("wire",),
        "1",
        "what the wire is: contact, messenger, auxiliary or stitch",
        "text",
    ),
    Entry(
        "dropper_span", "dropper_span", ("dropper",), "1", "span of the dropper, from 1", "count"
    ),
    Entry(
        "dropper_number",
        "dropper_number",
        ("dropper",),
        "1",
        "number of the dropper in its span, from 1",
        "count",
    ),
    Entry(
        "dropper_wire",
        "dropper_wires",
        ("dropper", "side"),
        "1",
        "numbers of the wires above and below, from 0",
        "count",
    ),
    Entry("dropper_x", "dropper_x", ("dropper",), "m", "position of the dropper"),
    Entry(
        "dropper_length_unstrained",
        "dropper_lengths_unstrained",
        ("dropper",),
        "m",
        "unstrained dropper length, clamp to clamp",
    ),
    Entry(
        "dropper_length",
        "dropper_lengths",
        ("dropper",),
        "m",
        "stretched dropper length, clamp to clamp",
    ),
    Entry(
        "dropper_force",
        "dropper_forces",
        ("dropper",),
        "N",
        "static dropper force, tension positive",
    ),
    Entry(
        "dropper_height",
        "dropper_heights",
        ("dropper",),
        "m",
        "height of the lower wire at the dropper",
    ),
    Entry(
        "support_number",
        "support_number",
        ("support",),
        "1",
        "number of the support, from 1",
        "count",
    ),
    Entry(
        "support_wire",
        "support_wire",
        ("support",),
        "1",
        "number of the contact wire that is held there, from 0",
        "count",
    ),
    Entry("support_x", "support_x", ("support",), "m", "position of the support"),
    Entry(
        "support_height",
        "support_heights",
        ("support",),
        "m",
        "height of the contact wire at the support",
    ),
    Entry(
        "arm_support",
        "arm_supports",
        ("arm",),
        "1",
        "row of the support with the arm, from 1",
        "count",
    ),
    Entry("arm_force", "arm_forces", ("arm",), "N", "steady-arm force, tension positive"),
    Entry(
        "arm_angle",
        "arm_angles",
        ("arm",),
        "rad",
        "inclination of the arm, positive when the far end is above the wire",
    ),
    Entry("arm_end", "arm_ends", ("arm", "component"), "m", "far end of the arm: x, y, z"),
    Entry(
        "suspension_free_height",
        "suspension_free_heights",
        ("suspension",),
        "m",
        "height at which the spring that carries a messenger wire is slack",
    ),
    Entry(
        "contact_preload",
        "contact_preloads",
        ("support",),
        "N",
        "upward force of the contact-wire support spring, 0 where there is none",
    ),
    Entry(
        "joint_pull",
        "joint_pulls",
        ("joint", "component"),
        "N",
        "force of a joint of two wires on the one that holds the other",
    ),
    Entry(
        "end_pull",
        "end_pulls",
        ("end", "wire"),
        "N",
        "longitudinal force on the ends of the wire: left and right",
    ),
    Entry("weight", "weight", (), "N", "weight of the line"),
    Entry("reaction", "reaction", (), "N", "sum of the vertical support reactions"),
    Entry("iterations", "iterations", (), "1", "Newton iterations of the shape finding", "count"),
    Entry("residual", "residual", (), "N", "largest out-of-balance nodal force"),
)
