// Forces of a row of elements from the motion of its nodes.
#pragma once

#include "line/line.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Motion of the nodes of a row: coordinates, what the mass acts on, a + (1 + alpha) a_R v, and
// velocities; those of the slopes in single precision, for all pieces.
struct Motion {
    Row q, s;
    Doubles v[2][3];
    Floats turn[3];
};

// Forces on the left and the right nodes of a row of elements.
struct Ends {
    Doubles left[6], right[6];
};

// Elastic forces of a row of elements, of both halves, on their parabolas. With kSingle the nonlinear
// part of bending is formed in single precision, in which a register holds both halves: that changes the
// contact force of AC simple by at most 4e-7 N rms. Axial strains need double precision.
template <bool kSingle>
TAUTWIRE_INLINE void elastic_forces(
    const Element* element, const Parabola<Doubles> (&e)[2], Parabola<Doubles> (&f)[2]) {
    if constexpr (kSingle) {
        const Strain<Doubles> strain[2] = {strain_of(e[0]), strain_of(e[1])};
        Strain<Floats> joined;
        TAUTWIRE_UNROLL
        for (int n = 0; n < 5; ++n) joined.E[n] = join(strain[0].E[n], strain[1].E[n]);
        joined.H = join(strain[0].H, strain[1].H);
        const Moments<Floats> m = bending_moments(
            joined, join(element[0].stiffness.bending, element[1].stiffness.bending));
        TAUTWIRE_UNROLL
        for (int half = 0; half < 2; ++half) {
            const Moments<Doubles> bending = {widen(m.m00, half), widen(m.m01, half), widen(m.m02, half),
                                              widen(m.m11, half), widen(m.m12, half), widen(m.m22, half)};
            f[half] = (leading_moments(strain[half], element[half].stiffness) + bending) * e[half];
        }
    } else {
        for (int half = 0; half < 2; ++half) f[half] = elastic_force(e[half], element[half].stiffness);
    }
}

// b_R K0 of a row of elements on (r2 - r1, r1', r2') of all pieces, packed. A symmetric matrix whose
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

// Forces of one half's elements on their nodes: minus `f` (per length, on the parabola) and minus
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

}  // namespace tautwire::TAUTWIRE_ISA
