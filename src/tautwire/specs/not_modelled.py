"""What a real line may have and a case cannot describe yet; refused by name, never ignored."""

from __future__ import annotations

NOT_MODELLED: dict[str, tuple[str, ...]] = {
    "curved track": ("curve", "curves", "curvature", "radius", "track_radius"),
    "cant of the track": ("cant", "track_cant", "superelevation"),
    "neutral section or section insulator": (
        "neutral_section",
        "neutral_sections",
        "phase_break",
        "section_insulator",
        "insulator",
    ),
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

SAID_ELSEWHERE: dict[str, tuple[str, ...]] = {
    "a stitch wire is one of 'wires', with 'role: stitch', 'from', 'to' and 'clamped_to'": (
        "stitch_wire",
        "y_wire",
        "stitch_wires",
        "stitched",
    ),
    "a second contact wire is one of 'wires', with 'role: contact' and 'side'": (
        "twin",
        "twin_contact",
        "twin_contact_wire",
        "second_contact_wire",
        "contact_wires",
    ),
    "an auxiliary messenger wire is one of 'wires', with 'role: auxiliary' and 'below'": (
        "auxiliary_wire",
        "auxiliary_messenger",
        "compound",
    ),
    "overlaps follow from 'tension_lengths' that share spans; their sizes stand under 'overlaps'": (
        "overlap",
        "tension_sections",
    ),
    "the point that holds a tension length is its 'fixed_point'": (
        "mid_point",
        "mid_point_anchor",
        "midpoint_anchor",
    ),
}
"""Where features are written, and other keys by which an input may ask for them."""

PAGE = "Not modelled yet"
"""Title of the page of the documentation that lists these features."""


def where_said(key: str) -> str | None:
    """Return where a feature is written that a key asks for in another way, or None."""
    word = _word(key)
    return next((text for text, keys in SAID_ELSEWHERE.items() if word in keys), None)


def _word(key: str) -> str:
    return key.strip().lower().replace("-", "_").replace(" ", "_")


def feature_of(key: str) -> str | None:
    """Return the feature that a key asks for, or None when it asks for none of these."""
    word = _word(key)
    for feature, keys in NOT_MODELLED.items():
        if word in keys:
            return feature
    return None
