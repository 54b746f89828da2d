"""What a real line may have and a case cannot describe yet; refused by name, never ignored."""

from __future__ import annotations

NOT_MODELLED: dict[str, tuple[str, ...]] = {
    "stitch wire (Y wire)": ("stitch_wire", "y_wire", "stitch", "stitched", "stitch_wires"),
    "second contact wire (twin contact wire)": (
        "twin",
        "twin_contact",
        "twin_contact_wire",
        "contact_2",
        "contact2",
        "second_contact",
        "second_contact_wire",
        "contact_wires",
    ),
    "auxiliary messenger wire (compound catenary)": (
        "auxiliary",
        "auxiliary_wire",
        "auxiliary_messenger",
        "compound",
    ),
    "overlap of two wire runs": ("overlap", "overlaps", "tension_sections"),
    "curved track": ("curve", "curves", "curvature", "radius", "track_radius"),
    "cant of the track": ("cant", "track_cant", "superelevation"),
    "neutral section or section insulator": (
        "neutral_section",
        "neutral_sections",
        "phase_break",
        "section_insulator",
        "insulator",
    ),
    "mid-point anchor": ("mid_point", "mid_point_anchor", "midpoint_anchor", "fixed_point"),
    "crossing or turnout wire": ("crossing", "turnout", "switch", "crossing_wire"),
    "rigid overhead conductor rail": ("rigid", "conductor_rail", "rigid_catenary"),
    "elastic cantilever": ("cantilever", "cantilevers"),
    "tensioning device with friction or spring": ("tensioning", "tensioner", "balance_weight"),
    "wind": ("wind", "wind_speed", "gust"),
    "temperature and ice": ("temperature", "ice", "ice_load"),
    "uplift stop of the steady arm": ("uplift_stop", "uplift_limit"),
    "several contact strips or a rotating head": ("strips", "contact_strips", "head_roll"),
    "active pantograph control": ("control", "controller", "active_control"),
    "varying speed": ("speed_profile", "acceleration"),
}
"""Feature, as a person calls it, and the keys by which an input would ask for it."""

PAGE = "Not modelled yet"
"""Title of the page of the documentation that lists these features."""


def feature_of(key: str) -> str | None:
    """Return the feature that a key asks for, or None when it asks for none of these."""
    word = key.strip().lower().replace("-", "_").replace(" ", "_")
    for feature, keys in NOT_MODELLED.items():
        if word in keys:
            return feature
    return None
