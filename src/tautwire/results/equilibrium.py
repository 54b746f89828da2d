"""The static state of a line: positions, forces and unstrained lengths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Static state found by :func:`tautwire.find_shape`.

    Axis order of per-dropper data is span by span, left to right; of per-support data left to
    right, both anchors included.

    Attributes
    ----------
    position : (n_dof,) m
        Nodal coordinates, node by node ``x y z x' y' z'``; node = 2*station + wire
        (0 contact wire, 1 messenger wire).
    cable_lengths : (n_element,) m
        Unstrained length of every wire element.
    station_x : (n_station,) m
        Longitudinal coordinate of the stations.
    dropper_span, dropper_number : (n_dropper,)
        1-based span of each dropper and its 1-based number within the span.
    dropper_x : (n_dropper,) m
    dropper_lengths_unstrained, dropper_lengths : (n_dropper,) m
        Unstrained and stretched dropper lengths, clamp to clamp.
    dropper_forces : (n_dropper,) N
        Mean axial force, tension positive.
    dropper_heights : (n_dropper,) m
        Height of the contact wire at the droppers.
    support_x, support_heights : (n_support,) m
        Position of the supports and height of the contact wire there.
    arm_supports : (n_arm,)
        1-based numbers of the supports that carry a steady arm.
    arm_forces : (n_arm,) N
        Axial force of the steady arms, tension positive.
    arm_angles : (n_arm,) rad
        Inclination of the arms, positive when the far end is above the wire.
    arm_ends : (n_arm, 3) m
        Far (hinged) ends of the arms.
    messenger_free_heights : (n_support - 2,) m
        Height at which the messenger-wire support springs are slack, supports 2 .. n-1.
    contact_preloads : (n_support - 2,) N
        Upward force of the contact-wire support springs (closure ``spring``), otherwise 0.
    end_pulls : (2, 2) N
        Longitudinal force on the wire ends: left and right; contact and messenger wire.
    weight, reaction : float N
        Weight of the line, and sum of the vertical reactions of all supports and anchors.
    iterations, residual : int, N
        Newton iterations of the shape finding and the largest out-of-balance nodal force.
    """

    position: Array
    cable_lengths: Array
    station_x: Array
    dropper_span: NDArray[np.int64]
    dropper_number: NDArray[np.int64]
    dropper_x: Array
    dropper_lengths_unstrained: Array
    dropper_lengths: Array
    dropper_forces: Array
    dropper_heights: Array
    support_x: Array
    support_heights: Array
    arm_supports: NDArray[np.int64]
    arm_forces: Array
    arm_angles: Array
    arm_ends: Array
    messenger_free_heights: Array
    contact_preloads: Array
    end_pulls: Array
    weight: float
    reaction: float
    iterations: int
    residual: float

    @property
    def contact_position(self) -> Array:
        """Coordinates of the contact wire, ``(n_station, 3)`` [m]."""
        return self.position.reshape(-1, 2, 2, 3)[:, 0, 0]

    @property
    def messenger_position(self) -> Array:
        """Coordinates of the messenger wire, ``(n_station, 3)`` [m]."""
        return self.position.reshape(-1, 2, 2, 3)[:, 1, 0]


@dataclass(frozen=True, eq=False)
class Elasticity:
    """Static uplift per vertical force on the contact wire.

    Attributes
    ----------
    force : float N
        Force at which the elasticity was evaluated (the line is nonlinear).
    span : (n_point,)
        1-based span of the point; a support belongs to the span it begins.
    kind : tuple of str
        ``"support"``, ``"dropper"`` or ``"middle"``.
    index : (n_point,)
        0 for a support, the dropper's number, or for a middle the number of the dropper on
        its left (0: between the support and dropper 1).
    x : (n_point,) m
    elasticity : (n_point,) m/N
    """

    force: float
    span: NDArray[np.int64]
    kind: tuple[str, ...]
    index: NDArray[np.int64]
    x: Array
    elasticity: Array

    @property
    def nonuniformity(self) -> float:
        """Non-uniformity u = (e_max - e_min)/(e_max + e_min), a fraction.

        Definition of EN 50119 as remembered (edition and clause not verified).
        """
        high, low = float(self.elasticity.max()), float(self.elasticity.min())
        return (high - low) / (high + low)

    def __str__(self) -> str:
        rows = [f"elasticity under {self.force:g} N [mm/N]"]
        for span, kind, index, x, e in zip(
            self.span, self.kind, self.index, self.x, self.elasticity, strict=True
        ):
            label = kind if kind == "support" else f"{kind} {index}"
            rows.append(f"span {span:3d}  {label:<12} x = {x:8.3f} m  {1e3 * e:.4f}")
        rows.append(f"non-uniformity {100 * self.nonuniformity:.1f} %")
        return "\n".join(rows)
