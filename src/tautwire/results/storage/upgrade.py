"""Result files of older formats, turned into what the present one holds.

Pure functions on plain arrays, one per version, applied before objects are made.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Values = dict[str, Any]


def equilibrium_from_1(old: Values) -> Values:
    """Return the variables of a format 2 static state for those of format 1.

    Format 1 knew one contact and one messenger wire on common stations, node = 2 station + wire.

    Parameters
    ----------
    old
        Variables by name.
    """
    station, droppers = old["station_x"], len(old["dropper_x"])
    supports = len(old["support_x"])
    kept = {k: v for k, v in old.items() if k not in ("station_x", "messenger_free_height")}
    preload = np.zeros(supports)
    preload[1:-1] = old["contact_preload"]
    return kept | {
        "node_s": np.repeat(station, 2),
        "node_wire": np.tile(np.arange(2), len(station)),
        "wire_name": np.array(["contact", "messenger"], dtype=object),
        "wire_role": np.array(["contact", "messenger"], dtype=object),
        "dropper_wire": np.tile([1, 0], (droppers, 1)),
        "support_number": np.arange(1, supports + 1),
        "support_wire": np.zeros(supports, dtype=np.int64),
        "suspension_free_height": old["messenger_free_height"],
        "contact_preload": preload,
        "joint_pull": np.empty((0, 3)),
    }


def snapshots_from_1(old: Values) -> Values:
    """Return the variables of format 2 snapshots for those of format 1."""
    points = len(old["x"])
    return {
        "time": old["time"],
        "x": np.tile(old["x"], 2),
        "wire": np.repeat(np.arange(2), points),
        "z": np.concatenate([old["contact_z"], old["messenger_z"]], axis=1),
    }
