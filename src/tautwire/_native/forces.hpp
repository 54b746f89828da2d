// Forces of a row of elements, droppers and supports from the motion of its nodes.
#pragma once

#include "line.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Motion of the nodes of a row: coordinates, what the mass acts on, a + (1 + alpha) a_R v, and
// velocities; those of the slopes in single precision, for both wires.
struct Motion {
    Row q, s;
    Doubles v[2][3];
    Floats turn[3];
};

// Forces on the left and the right nodes of a row of elements.
struct Ends {
    Doubles left[6], right[6];
};

// b_R K0 of a row of elements on (r2 - r1, r1', r2') of both wires, packed. A symmetric matrix whose
// forces on r1 and r2 are opposite needs no more.
struct Damping {
    Floats k[kPacked];
};

// Damping forces of a row of elements on (r2, r1', r2').
TAUTWIRE_INLINE void damping_forces(
    const Damping& damping, const Motion& left, const Motion& right, Floats (&y)[9]) {
    Floats x[9];
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        x[i] = join(right.v[0][i] - left.v[0][i], right.v[1][i] - left.v[1][i]);
        x[3 + i] = left.turn[i];
        x[6 + i] = right.turn[i];
    }
    TAUTWIRE_UNROLL
    for (int i = 0; i < 9; ++i) y[i] = damping.k[packed(i, i)] * x[i];
    TAUTWIRE_UNROLL
    for (int i = 0; i < 9; ++i)
        TAUTWIRE_UNROLL
        for (int j = i + 1; j < 9; ++j) {
            y[i] += damping.k[packed(i, j)] * x[j];
            y[j] += damping.k[packed(i, j)] * x[i];
        }
}

// Forces of one wire's elements on their nodes: minus `f` (per length, on the parabola) and minus
// the consistent mass times s, split into parts that are even and odd under exchange of the ends.
TAUTWIRE_INLINE Ends wire_forces(const Element& element, const Parabola<Doubles>& f,
                                 const Doubles* s_left, const Doubles* s_right) {
    Ends out;
    const Inertia<Doubles>& m = element.inertia;
    const Doubles half = 0.5 * element.length, quarter = 0.25 * element.length;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        const Doubles sum = s_left[i] + s_right[i], difference = s_left[i] - s_right[i];
        const Doubles slope_sum = s_left[3 + i] + s_right[3 + i];
        const Doubles slope_difference = s_left[3 + i] - s_right[3 + i];
        const Doubles stretch = f.c[0][i] - f.c[2][i];
        const Doubles even = m.even * sum + m.even_cross * slope_difference;
        const Doubles odd = m.odd * difference + m.odd_cross * slope_sum - 1.5 * stretch;
        out.left[i] = -(odd + even);
        out.right[i] = odd - even;
        const Doubles mean = m.odd_cross * difference + m.odd_slope * slope_sum + half * f.c[2][i] -
                             quarter * stretch;
        const Doubles skew =
            m.even_cross * sum + m.even_slope * slope_difference - half * f.c[1][i];
        out.left[3 + i] = -(mean + skew);
        out.right[3 + i] = skew - mean;
    }
    return out;
}

// Axial force of droppers; they carry tension only.
TAUTWIRE_INLINE Doubles dropper_force(const Hanger& hanger, Doubles length, Doubles rate) {
    return maximum(broadcast<Doubles>(0.0),
                   hanger.stiffness * (length - hanger.length) + hanger.damping * rate);
}

// Add dropper forces to the forces on the nodes of a row; return which droppers are taut (1 or 0).
TAUTWIRE_INLINE Doubles add_hangers(const Hanger& hanger, const Motion& at, Row& r) {
    Doubles t[3], rate[3];
    for (int i = 0; i < 3; ++i) {
        t[i] = at.q[1][i] - at.q[0][i];
        rate[i] = at.v[1][i] - at.v[0][i];
    }
    const Doubles length = square_root(dot(t, t)), inverse = 1.0 / length;
    for (Doubles& component : t) component *= inverse;
    const Doubles axial = dropper_force(hanger, length, dot(t, rate));
    for (int i = 0; i < 3; ++i) {
        r[0][i] += axial * t[i];
        r[1][i] -= axial * t[i];
    }
    return is_positive(axial);
}

// Add the forces of arms and springs, and clear those on held degrees of freedom.
TAUTWIRE_INLINE void add_supports(const Support& support, const Motion& at, Row& r) {
    Doubles t[3];
    for (int i = 0; i < 3; ++i) t[i] = at.q[0][i] - support.arm_end[i];
    const Doubles length = square_root(dot(t, t));
    const Doubles tension = support.arm_stiffness * (length - support.arm_length) / length;
    const Doubles* k = support.arm_damping;
    const Doubles(&v)[3] = at.v[0];
    r[0][0] -= tension * t[0] + k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
    r[0][1] -= tension * t[1] + k[1] * v[0] + k[3] * v[1] + k[4] * v[2];
    r[0][2] -= tension * t[2] + k[2] * v[0] + k[4] * v[1] + k[5] * v[2];
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            r[wire][i] -= support.spring_stiffness[wire][i] *
                              (at.q[wire][i] - support.spring_free[wire][i]) +
                          support.spring_damping[wire][i] *
                              (i < 3 ? at.v[wire][i] : widen(at.turn[i - 3], wire));
            r[wire][i] *= support.free[wire][i];
        }
}

}  // namespace tautwire::TAUTWIRE_ISA
