"""Lines that nobody chose: topology, spans, track, supports, fittings and pantographs drawn."""

from __future__ import annotations

import random
from typing import Any

Data = dict[str, Any]

KINDS = ("simple", "stitched", "twin", "compound", "two messengers", "alone")


def random_line(seed: int) -> Data:
    """Return a case as plain data, in the words of schema 2, SI units."""
    chance = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    spans = [float(5 * chance.randint(8, 11)) for _ in range(chance.randint(9, 12))]
    if kind == "alone":
        spans = [25.0 + 5.0 * chance.randint(0, 1) for _ in spans]
    case: Data = {
        "schema": 2,
        "name": f"random-{seed}",
        "line": {"spans": len(spans), "span_length": spans, "damping": {"stiffness": 1e-4}},
        "wires": wires(chance, kind),
        "droppers": droppers(chance, kind, spans),
        "pantographs": pantographs(chance),
        "scenario": {"speed": chance.uniform(20.0, 60.0), "uplift_force": 110.0},
        "settings": {
            "nodes_between_droppers": chance.randint(4, 5),
            "section": [3, len(spans) - 4],
            "time_step": 2e-3,
        },
    }
    case |= along(chance, kind, spans, case["wires"]["contact"])
    stagger = track(chance, spans, case)
    case["supports"] = supports(chance, kind, stagger)
    case |= extras(chance, kind, spans)
    return case


def wire(chance: random.Random, tension: tuple[float, float], **more: Any) -> Data:
    """Return a wire of copper or bronze."""
    section = chance.uniform(65.0, 150.0)
    own = {
        "tension": round(chance.uniform(*tension), -2),
        "mass": 0.0089 * section,
        "axial_stiffness": 1.2e5 * section,
        "bending_stiffness": 0.008 * section**2,
        "diameter": 1e-3 * (1.27 * section) ** 0.5,
        "thermal_expansion": 1.7e-5,
    }
    return own | more


def wires(chance: random.Random, kind: str) -> Data:
    """Return the wires of a kind of line."""
    found: Data = {"contact": wire(chance, (10e3, 27e3))}
    if kind == "alone":
        return found
    found["messenger"] = wire(chance, (12e3, 21e3))
    if kind == "stitched":
        found["messenger"] = wire(chance, (18e3, 21e3))
        found["stitch"] = wire(chance, (2e3, 3.5e3), role="stitch", **{"from": -8.0, "to": 8.0}) | {
            "clamped_to": "messenger",
            "mass": 0.31,
            "axial_stiffness": 3.5e6,
        }
    if kind == "twin":
        found["contact"] |= {"side": -0.02, "tension": 10e3}
        found["contact-2"] = {**found["contact"], "side": 0.02, "role": "contact"}
    if kind == "compound":
        found["messenger"] = wire(chance, (22e3, 26e3))
        found["auxiliary"] = wire(chance, (12e3, 15e3), role="auxiliary", below=1.0)
    if kind == "two messengers":
        found["messenger"] |= {"side": -0.3}
        found["messenger-2"] = {**found["messenger"], "side": 0.3, "role": "messenger"}
    return found


def droppers(chance: random.Random, kind: str, spans: list[float]) -> list[Data]:
    """Return the droppers of a kind of line, every span with places of its own."""
    if kind == "alone":
        return []
    common = {
        "stiffness": 1e5 * chance.randint(1, 3),
        "mass": 0.1,
        "diameter": 5e-3,
        "thermal_expansion": 1.7e-5,
        "clamp_contact": 0.15,
        "clamp_messenger": 0.15,
    }
    sag = chance.uniform(0.0, 0.5e-3)

    def between(first: float, distance: float, shift: float = 0.0) -> Data:
        rows, depths = [], []
        for span in spans:
            count = max(2, round((span - 2.0 * first) / distance) + 1)
            step = (span - 2.0 * first) / (count - 1)
            rows.append([first + shift + step * (k + 0.0) for k in range(count)])
            depths.append([4.0 * sag * x * (span - x) / span for x in rows[-1]])
        return {"positions": rows, "presag": depths}

    first, distance = chance.uniform(4.0, 6.0), chance.uniform(5.5, 8.0)
    if kind == "stitched":
        about = {"from": "stitch", "about": "mast", "positions": [-4.0, 4.0], "presag": [0.0, 0.0]}
        return [{**common, **about}, {**common, **between(12.0, distance)}]
    if kind == "twin":
        own = between(first, 2.0 * distance, -1.5), between(first, 2.0 * distance, 1.5)
        return [{**common, **own[0]}, {**common, "to": "contact-2", **own[1]}]
    if kind == "compound":
        upper = between(5.0, 10.0)
        upper.pop("presag")
        return [
            {**common, "to": "auxiliary", **upper},
            {**common, "from": "auxiliary", **between(2.5, 5.0)},
        ]
    if kind == "two messengers":
        own = between(first, 2.0 * distance, -1.5), between(first, 2.0 * distance, 1.5)
        return [{**common, **own[0]}, {**common, "from": "messenger-2", **own[1]}]
    return [{**common, **between(first, distance)}]


def pantographs(chance: random.Random) -> list[Data]:
    """Return one pantograph or two."""
    found: list[Data] = [{"use": "benchmark-2015", "name": "front"}]
    if chance.random() < 0.5:
        behind = chance.uniform(35.0, 60.0)
        found.append({"use": "DSA250", "name": "rear", "behind": behind})
    return found


def along(chance: random.Random, kind: str, spans: list[float], contact: Data) -> Data:
    """Return ends, or two tension lengths with an overlap whose wires can rise within a span."""
    masts = len(spans) + 1
    most = 0.7 * min(spans) ** 2 * 9.81 * contact["mass"] / (2.0 * contact["tension"])
    if chance.random() < 0.4:
        ends = chance.choice(["anchored", {"left": "weighted", "right": "anchored"}])
        fixed = {"name": "T1", "masts": [1, masts], "ends": "weighted", "fixed_point": masts // 2}
        return {"tension_lengths": [fixed]} if chance.random() < 0.3 else _ended(ends, spans)
    shared, rise = chance.randint(3, 5), min(most, chance.uniform(0.2, 0.5))
    rise = min(rise, 0.25) if kind == "compound" else rise  # below the auxiliary wire
    last = (masts + shared) // 2 + 1
    return {
        "tension_lengths": [
            {"name": "T1", "masts": [1, last], "ends": {"left": "anchored", "right": "weighted"}},
            {"name": "T2", "masts": [last - shared, masts], "ends": "weighted",
             "fixed_point": last + (masts - last) // 2},
        ],
        "overlaps": [
            {"separation": chance.uniform(0.2, 0.45), "rise": rise, "anchor_rise": 2.0 * rise}
        ],
    }  # fmt: skip


def _ended(ends: Any, spans: list[float]) -> Data:
    return {
        "line": {
            "spans": len(spans),
            "span_length": spans,
            "damping": {"stiffness": 1e-4},
            "ends": ends,
        }
    }


def track(chance: random.Random, spans: list[float], case: Data) -> float | list[float]:
    """Give a case a track, and return the stagger that goes with it: outside of a curve."""
    length = sum(spans)
    if chance.random() < 0.5:
        rise = chance.uniform(-0.02, 0.02)
        profile = [
            {"at": 0.0, "height": 0.0},
            {"at": 0.5 * length, "height": 0.5 * length * rise, "radius": 8000.0},
            {"at": length, "height": 0.3 * length * rise},
        ]
    else:
        profile = []
    if chance.random() < 0.5:
        if profile:
            case["track"] = {"profile": profile}
        return chance.choice([0.15, 0.2, 0.25])
    side, radius = chance.choice(["left", "right"]), float(100 * chance.randint(8, 25))
    bend = {"arc": length, "radius": radius, "side": side, "cant": chance.choice([0.0, 0.08])}
    case["track"] = {"pieces": [bend], "profile": profile} if profile else [bend]
    return [-0.15 if side == "left" else 0.15] * (len(spans) + 1)


def supports(chance: random.Random, kind: str, stagger: float | list[float]) -> Data:
    """Return the supports of a kind of line."""
    found: Data = {"contact_height": 5.3, "contact_stagger": stagger, "closure": "height"}
    if kind == "alone":
        spring = {"stiffness": 2e3, "mass": 1.0, "damping": 20.0}
        return found | {"closure": "spring", "spring": spring}
    found["encumbrance"] = {"compound": 1.6, "stitched": 1.6}.get(kind, 1.3)
    if chance.random() < 0.5:
        found |= {"closure": "lift", "share": chance.uniform(0.0, 0.4)}
    if chance.random() < 0.4:
        found["stop"] = {"gap": chance.uniform(0.08, 0.12), "stiffness": 1e5}
    if chance.random() < 0.4:
        found["cantilever"] = {"arm": {"lateral": 2e5, "vertical": 1e5, "mass": 5.0}}
        if chance.random() < 0.5:
            found["cantilever"]["messenger"] = {"lateral": 3e5, "along": 4e3}
    return found


def extras(chance: random.Random, kind: str, spans: list[float]) -> Data:
    """Return stays, bodies and conditions."""
    found: Data = {}
    if chance.random() < 0.5:
        found["bodies"] = [
            {"name": "insulator", "wire": "contact", "span": 2, "at": 0.47 * spans[1],
             "length": 1.2, "mass": 5.0, "bending_stiffness": 900.0},
        ]  # fmt: skip
    if chance.random() < 0.5:
        found["stays"] = [
            {"name": "wind stay", "wire": "contact", "span": 2, "at": 0.31 * spans[1], "end_y": 3.0,
             "end_z": 5.8, "stiffness": 5e5, "law": chance.choice(["rope", "bar"])},
        ]  # fmt: skip
    if kind != "alone" or chance.random() < 0.5:
        warm = {"name": "warm", "temperature": chance.choice([35.0, -10.0]), "reference": 15.0}
        found["conditions"] = [warm, {"name": "windy", "wind": {"speed": 12.0, "from": "left"}}]
    return found
