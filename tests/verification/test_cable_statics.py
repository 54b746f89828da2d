"""Static closed forms of one wire: elastica, elastic catenary, string and beam under a force."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import root_scalar
from scipy.sparse.linalg import splu
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import System, internal_force, tangent_parts
from tautwire.numerics.statics.newton import NewtonSettings, damped_newton
from tautwire.status import Status

from ..lines import CONTACT_WIRE, hang, loaded, straight_wire, wire_elements

Array = NDArray[np.float64]
Record = Callable[..., bool]
GRAVITY, MASS, SPAN = 9.81, 1.35, 50.0
WEIGHT = GRAVITY * MASS


# ---- elastica -----------------------------------------------------------------------------------


def cantilever(elements: int, axial: float) -> System:
    """Return a beam of length 1 and EI 1 along x, clamped at the left, moving in the x-z plane."""
    system = wire_elements(np.full(elements, 1.0 / elements), axial=axial, bending=1.0, mass=1.0)
    fixed = np.zeros((elements + 1, 6), dtype=bool)
    fixed[:, [1, 4]] = True
    fixed[0, [0, 2, 5]] = True
    return system.with_(fixed=fixed.ravel())


def tip_under(system: System, force: float, steps: int = 4) -> Array:
    """Return the position of the tip under a vertical force, by full Newton in load steps."""
    pattern, free = Pattern(system), np.flatnonzero(~system.fixed)
    tip = 6 * (system.node_count - 1)
    load = np.zeros(system.dof_count)

    def residual(q: Array) -> Array:
        return np.where(system.fixed, 0.0, internal_force(system, q).nodal - load)

    def direction(q: Array, r: Array) -> Array:
        k = pattern.csr(pattern.values(tangent_parts(system, q))).tocsc()[free][:, free]
        step = np.zeros(system.dof_count)
        step[free] = splu(k).solve(-r[free])
        return step

    q = system.position
    for share in np.arange(1, steps + 1) / steps:
        load[tip + 2] = share * force
        limits = np.full(system.dof_count, 0.3)
        result = damped_newton(q, residual, direction, limits, NewtonSettings(1e-9, 1e-6))
        assert result.status is Status.DONE
        q = result.x
    return q[[tip, tip + 2]]


def elastica_tip(load: float) -> Array:
    """Return the tip (x, z) of an inextensible cantilever of length 1 under ``P L^2/(EI)``.

    K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272-275, in elliptic integrals of
    the parameter m = (1 + sin(tip angle))/2.
    """

    def integrals(angle: float) -> tuple[float, float, float]:
        m = 0.5 * (1.0 + np.sin(angle))
        return m, float(np.arcsin(1.0 / np.sqrt(2.0 * m))), float(np.sqrt(load))

    def length_fault(angle: float) -> float:
        m, phi, root = integrals(angle)
        return float(ellipk(m) - ellipkinc(phi, m)) - root

    angle = float(root_scalar(length_fault, bracket=(1e-9, 0.5 * np.pi - 1e-9), xtol=1e-15).root)
    m, phi, root = integrals(angle)
    z = 1.0 - 2.0 / root * float(ellipe(m) - ellipeinc(phi, m))
    return np.array([np.sqrt(2.0 * np.sin(angle)) / root, z])


@pytest.mark.parametrize("load", [1.0, 4.0])
def test_large_deflection_cantilever(load: float, record_validation: Record) -> None:
    """A nearly inextensible cantilever under a tip force follows the elastica (Bisshopp and
    Drucker 1945) within 1e-4 of its length, up to a deflection of 67 % of the length."""
    tip, exact = tip_under(cantilever(48, 1e7), load), elastica_tip(load)
    assert record_validation(
        "Closed forms, one wire",
        f"elastica, P L²/EI = {load:g}: tip deflection over length",
        ours=tip[1],
        unit="",
        target=exact[1],
        absolute=1e-4,
        source="Bisshopp and Drucker 1945, elliptic integrals",
    )
    assert abs(tip[0] - exact[0]) <= 1e-4


def test_clamped_beam_converges_with_order_4() -> None:
    """The tip of a bent cantilever converges with twice the order of its curvature, 2 (p - 1) = 4
    for cubics, within 0.15 (self-convergence, four halvings)."""
    tips = [tip_under(cantilever(n, 10.0), 1.0)[0] for n in (8, 16, 32, 64)]
    change = np.abs(np.diff(tips))
    assert np.log2(change[:-1] / change[1:]) == pytest.approx(4.0, abs=0.15)


# ---- hanging wire -------------------------------------------------------------------------------


def catenary(stretch: Callable[[float], float], tension: float, weight: float) -> tuple[float, ...]:
    """Return sag and unstrained length of a hanging cable, by quadrature of its equilibrium.

    With the horizontal tension H and w chi the vertical force at arc length chi from the middle,
    dx = lambda(N) H/N dchi and dz = lambda(N) w chi/N dchi, N^2 = H^2 + (w chi)^2.
    """

    def integral(part: Callable[[float], float], end: float) -> float:
        def rate(chi: float) -> float:
            force = float(np.hypot(tension, weight * chi))
            return stretch(force) * part(chi) / force

        return float(quad(rate, 0.0, end, epsabs=1e-14, epsrel=1e-13)[0])

    def fault(end: float) -> float:
        return integral(lambda _: tension, end) - 0.5 * SPAN

    end = float(root_scalar(fault, bracket=(0.2 * SPAN, SPAN), xtol=1e-14).root)
    return integral(lambda chi: weight * chi, end), 2.0 * end


def green_stretch(axial: float) -> Callable[[float], float]:
    """Return the stretch at which EA (lambda^2 - 1)/2 lambda equals a given force."""

    def stretch(force: float) -> float:
        value = 1.0 + force / axial
        for _ in range(6):
            fault = 0.5 * axial * (value**2 - 1.0) * value - force
            value -= fault / (0.5 * axial * (3.0 * value**2 - 1.0))
        return value

    return stretch


def hanging(elements: int, tension: float, axial: float) -> tuple[float, float, float, float]:
    """Return sag, unstrained length, support tension and vertical reaction of a hanging wire."""
    wire = straight_wire(SPAN, elements, tension=tension, axial=axial, bending=1e-9, mass=MASS)
    form = hang(wire, GRAVITY)
    assert form.newton.status is Status.DONE
    pull = form.reactions[:3]
    sag = -form.system.position.reshape(-1, 6)[elements // 2, 2]
    length = form.system.cables.length.sum()
    return float(sag), float(length), float(np.linalg.norm(pull)), float(pull[2])


def test_elastic_catenary_closed_form(record_validation: Record) -> None:
    """Sag, support tension and length of an elastic catenary agree with the closed form for a
    linear law (x = H s/EA + H/w asinh(w s/H)) to 1e-6 relative, at strains of 1e-4, where
    Green's strain and the linear law differ by less than 1e-7."""
    tension, axial = 22e3, 2.2e8
    ratio = WEIGHT / tension

    def fault(s: float) -> float:
        return tension * s / axial + np.arcsinh(ratio * s) / ratio - 0.5 * SPAN

    end = float(root_scalar(fault, bracket=(1.0, SPAN)).root)
    sag = WEIGHT * end**2 / (2.0 * axial) + (np.sqrt(1.0 + (ratio * end) ** 2) - 1.0) / ratio
    support = float(np.hypot(tension, WEIGHT * end))
    ours = hanging(16, tension, axial)
    for name, unit, value, target in (
        ("sag", "m", ours[0], sag),
        ("unstrained length", "m", ours[1], 2.0 * end),
        ("support tension", "N", ours[2], support),
    ):
        assert record_validation(
            "Closed forms, one wire",
            f"elastic catenary, 50 m, 22 kN: {name}",
            ours=value,
            unit=unit,
            target=target,
            relative=1e-6,
            source="elastic catenary",
        )


@pytest.mark.parametrize(("tension", "elements"), [(22e3, 8), (2e3, 32)])
def test_catenary_with_the_coded_law(tension: float, elements: int) -> None:
    """With the law as coded (Green strain) and the stiffness of a real wire, sag and length agree
    with the integrated equilibrium to 1e-6 relative, also for a sag of 4 % of the span."""
    sag, length = catenary(green_stretch(15e6), tension, WEIGHT)
    ours = hanging(elements, tension, 15e6)
    assert ours[0] == pytest.approx(sag, rel=1e-6)
    assert ours[1] == pytest.approx(length, rel=1e-6)
    assert 2.0 * ours[3] == pytest.approx(WEIGHT * ours[1], rel=1e-9)


def test_hanging_wire_converges_with_order_4() -> None:
    """The sag of a heavy wire converges with order p + 1 = 4 for cubics, within 0.15."""
    sag, _ = catenary(green_stretch(15e6), 22e3, WEIGHT)
    faults = np.array([abs(hanging(n, 22e3, 15e6)[0] - sag) for n in (4, 8, 16)])
    assert np.log2(faults[:-1] / faults[1:]) == pytest.approx(4.0, abs=0.15)


def test_shape_finding_converges_quadratically() -> None:
    """Once small, every Newton increment is of the order of the square of the one before."""
    wire = straight_wire(SPAN, 8, tension=2e3, bending=1e-3)
    steps = np.array(hang(wire, GRAVITY).newton.increments)
    small = np.flatnonzero((steps[:-1] < 0.02) & (steps[1:] > 1e-10))
    assert len(small) >= 2
    assert (steps[small + 1] <= 20.0 * steps[small] ** 2).all()


# ---- a force on a taut wire ---------------------------------------------------------------------


def uplift(wire: System, node: int, force: float) -> float:
    """Return the static uplift of a node under a vertical force on it."""
    load = np.zeros(wire.dof_count)
    load[6 * node + 2] = force
    response = loaded(wire, load)
    assert response.status is Status.DONE
    return float(response.position[6 * node + 2])


def test_string_uplift_under_a_force(record_validation: Record) -> None:
    """A force F at distances a, b from the ends of a taut string lifts it by F a b/(T L), less
    F/(2 T) sqrt(EI/T) where bending rounds the kink: within 0.01 %."""
    tension, bending = CONTACT_WIRE["tension"], CONTACT_WIRE["bending"]
    a, b = 20.0, 30.0
    value = uplift(straight_wire(SPAN, 200, weighted=True), 80, 1.0)
    string = a * b / (tension * SPAN)
    rounded = string - 0.5 / tension * np.sqrt(bending / tension)
    assert record_validation(
        "Closed forms, one wire",
        "uplift under 1 N at 20 m of 50 m, bending included",
        ours=1e3 * value,
        unit="mm",
        target=1e3 * rounded,
        relative=1e-4,
        source="F a b/(T L) - F/(2T) √(EI/T)",
    )
    assert value == pytest.approx(string, rel=0.005)


def test_uplift_grows_less_than_the_force_between_anchors() -> None:
    """Between anchors the wire tightens under a force; between weights the tension stays. For a
    large force the anchored wire is stiffer, for a small one both are alike."""
    ratio = [
        uplift(straight_wire(SPAN, 40), 20, force)
        / uplift(straight_wire(SPAN, 40, weighted=True), 20, force)
        for force in (1.0, 2000.0)
    ]
    assert ratio[0] == pytest.approx(1.0, abs=1e-4)
    assert ratio[1] < 0.9


def test_anchored_string_under_a_large_force() -> None:
    """An anchored string with a force F in its middle rises by w where F = 4 N w/l with the
    tension N(l) of its two straight halves; solved exactly, met within 0.5 %."""
    axial, force = CONTACT_WIRE["axial"], 2000.0
    wire = straight_wire(SPAN, 200, bending=1e-3)
    rest = wire.cables.length.sum()

    def fault(w: float) -> float:
        half = float(np.hypot(0.5 * SPAN, w))
        stretch = 2.0 * half / rest
        pull = 0.5 * axial * (stretch**2 - 1.0) * stretch
        return 2.0 * pull * w / half - force

    exact = float(root_scalar(fault, bracket=(1e-3, 5.0)).root)
    assert uplift(wire, 100, force) == pytest.approx(exact, rel=0.005)
