"""Where steady arms stand: pull-off or push-off, as stagger and curve ask."""

from __future__ import annotations

import numpy as np

from tautwire.errors import ModelError
from tautwire.line.labels import MastLabel, place
from tautwire.numerics.track import Track
from tautwire.specs.line.support import Arm, Supports

STRAIGHT = 1e-6
"""Change of direction [rad] below which a wire runs straight past a support."""

Values = tuple[float, ...]


def arm_ends(
    spec: Supports, masts: range, track: Track, s: Values, y: Values, z: Values
) -> dict[int, tuple[float, float]]:
    """Return the far ends (y, z) of given arms by mast [m]; none unless they are given.

    Parameters
    ----------
    spec
    masts
        0-based masts of the wire, its anchors included.
    track
    s, y, z
        Place, lateral position and height of the wire at all masts of the line [m].

    Raises
    ------
    ModelError
        When the wire runs straight past a support, so that its arm has nothing to pull.
    """
    if spec.closure != "arm":
        return {}
    inner = masts[1:-1]
    if spec.arm_end_y is not None and spec.arm_end_z is not None:
        given = zip(spec.arm_end_y, spec.arm_end_z, strict=True)
        return {
            mast: (end_y, end_z)
            for mast, (end_y, end_z) in enumerate(given)
            if mast in inner and end_y is not None and end_z is not None
        }
    sides = _pulling_sides(masts, track, s, (y, z))
    return {m: _far_end(spec.at(m).arm, sides[m], y[m], z[m]) for m in inner}


def _far_end(arm: Arm, side: float, y: float, z: float) -> tuple[float, float]:
    angle = float(arm.angle or 0.0)
    reach, rise = arm.length * np.cos(angle), arm.length * np.sin(angle)
    return float(y + side * reach), float(z + rise)


def _pulling_sides(
    masts: range, track: Track, s: Values, place_of_wire: tuple[Values, Values]
) -> dict[int, float]:
    """Return +1 or -1 for each support: the side to which its arm must pull.

    The wire bends there by the difference of the directions of its chords.
    """
    own = track.frames(np.array(s)[masts])
    lateral, height = (np.array(values)[masts] for values in place_of_wire)
    local = np.stack([np.zeros(len(masts)), lateral, height], axis=1)
    chords = np.diff(own.to_world(local), axis=0)
    chords /= np.linalg.norm(chords, axis=1, keepdims=True)
    bend = np.sum(np.diff(chords, axis=0) * own.axes[1:-1, 1], axis=1)
    faults = [
        f"{place(MastLabel.of_index(mast), s[mast])}: the contact wire runs straight "
        "there, so a steady arm has nothing to pull; give it stagger (supports.contact_stagger), "
        "give the far ends (arm_end_y, arm_end_z) or use closure 'spring'"
        for mast, change in zip(masts[1:-1], bend, strict=True)
        if abs(change) < STRAIGHT
    ]
    if faults:
        raise ModelError("\n".join(faults))
    return dict(zip(masts[1:-1], (-np.sign(bend)).tolist(), strict=True))
