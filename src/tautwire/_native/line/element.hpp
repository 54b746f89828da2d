// ANCF cable element on lanes: elastic force and tangent (paper eqs. 4 to 6).
//
// With t in [-1, 1] along the element of unstrained length L, the slope of the cubic Hermite
// interpolation is a parabola, and h its derivative:
//
//     p = r' = c0 + t c1 + t^2 c2,    h = dp/dt = L r''/2 = c1 + 2 t c2
//
// The energy per length depends on P = p.p, H = h.h and Q = p.h only:
//
//     psi = EA/8 (P - 1)^2 + k/2 (H/P^2 - Q^2/P^3),    k = 4 EI/L^2
//
// so its gradient is A p + B h with respect to p, and B p + C h with respect to h.
#pragma once

#include "simd/simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Five-point Gauss-Legendre rule: the middle, then two symmetric pairs; weights sum to 1.
inline constexpr double kPoint[3] = {0.0, 0.53846931010568309, 0.90617984593866399};
inline constexpr double kWeight[3] = {0.28444444444444444, 0.23931433524968324, 0.11846344252809454};

template <class V>
struct Stiffness {
    V half_axial;  // EA / 2
    V bending;     // 4 EI / L^2
};

// Consistent mass of an element of mass m and length L, for parts of the motion that are even and
// odd under exchange of the ends: sums and differences of s1 and s2 (nodes) and s1' and s2' (slopes).
template <class V>
struct Inertia {
    V even, odd;             // force from sum and difference of nodes: m/4, 17 m/140
    V even_cross, odd_cross;  // force from slopes, moment from nodes: m L/24, 3 m L/280
    V even_slope, odd_slope;  // moment from slopes: m L^2/120, m L^2/840

    static Inertia of(V m, V length) {
        return {(1.0 / 4.0) * m,           (17.0 / 140.0) * m,
                (1.0 / 24.0) * m * length, (3.0 / 280.0) * m * length,
                (1.0 / 120.0) * m * length * length, (1.0 / 840.0) * m * length * length};
    }
};

// Coefficients of the parabola, or the forces conjugate to them.
template <class V>
struct Parabola {
    V c[3][3];  // [power of t][component]
};

// Nodes hold (r, r'): the parabola of an element from its two nodes.
template <class V>
TAUTWIRE_INLINE Parabola<V> parabola(const V* left, const V* right, V inverse_length) {
    Parabola<V> out;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        const V d = inverse_length * (right[i] - left[i]);
        const V sum = left[3 + i] + right[3 + i];
        out.c[0][i] = 1.5 * d - 0.25 * sum;
        out.c[1][i] = 0.5 * (right[3 + i] - left[3 + i]);
        out.c[2][i] = 0.75 * sum - 1.5 * d;
    }
    return out;
}

template <class V>
TAUTWIRE_INLINE V dot(const V (&a)[3], const V (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class V>
struct Gradient {
    V A, B, C;
};

// Bending part of A, B and C at a point; H2 is 2 H, inverse 1/P.
template <class V>
TAUTWIRE_INLINE Gradient<V> bending_gradient(V inverse, V H2, V Q, V bending) {
    const V R = Q * inverse, C = bending * (inverse * inverse);
    return {-(C * inverse) * (H2 - 3.0 * (Q * R)), -R * C, C};
}

// Forces of the elastic energy per length on the coefficients of the parabola.
//
// They are combinations of the coefficients themselves, with factors M: averages over the element of
// A t^0 to A t^4, and of the like for B and C. P, H and Q are polynomials. Of the axial part, EA/2 (P - 1),
// the averages follow from those of powers of t, exactly as the rule has them; the bending part is
// summed over the points. Points at t and -t share even and odd parts of everything.
template <class V>
TAUTWIRE_INLINE Parabola<V> elastic_force(const Parabola<V>& e, const Stiffness<V>& stiffness) {
    const V P0 = dot(e.c[0], e.c[0]), P1 = 2.0 * dot(e.c[0], e.c[1]);
    const V H0 = dot(e.c[1], e.c[1]), P2 = H0 + 2.0 * dot(e.c[0], e.c[2]);
    const V P3 = 2.0 * dot(e.c[1], e.c[2]), P4 = dot(e.c[2], e.c[2]);

    const V half = stiffness.half_axial;
    const V n0 = half * P0 - half, n1 = half * P1, n2 = half * P2, n3 = half * P3, n4 = half * P4;
    V M00 = n0 + (1.0 / 3.0) * n2 + (1.0 / 5.0) * n4;
    V M01 = (1.0 / 3.0) * n1 + (1.0 / 5.0) * n3;
    V M02 = (1.0 / 3.0) * n0 + (1.0 / 5.0) * n2 + (1.0 / 7.0) * n4;
    V M12 = (1.0 / 5.0) * n1 + (1.0 / 7.0) * n3;
    V M22 = (1.0 / 5.0) * n0 + (1.0 / 7.0) * n2 + (1.0 / 9.0) * n4;

    const Gradient<V> middle =
        bending_gradient(1.0 / P0, H0 + H0, 0.5 * P1, kWeight[0] * stiffness.bending);
    M00 += middle.A;
    M01 += middle.B;
    V C0 = middle.C;
    TAUTWIRE_UNROLL
    for (int pair = 1; pair < 3; ++pair) {
        const double t = kPoint[pair], t2 = t * t;
        const V P_even = P0 + t2 * (P2 + t2 * P4), P_odd = t * (P1 + t2 * P3);
        const V H2_even = 2.0 * H0 + (8.0 * t2) * P4, H2_odd = (4.0 * t) * P3;
        const V Q_even = 0.5 * P1 + (1.5 * t2) * P3, Q_odd = t * (P2 + (2.0 * t2) * P4);
        const V P_right = P_even + P_odd, P_left = P_even - P_odd;
        const V both = 1.0 / (P_right * P_left), bending = kWeight[pair] * stiffness.bending;
        const Gradient<V> right =
            bending_gradient(both * P_left, H2_even + H2_odd, Q_even + Q_odd, bending);
        const Gradient<V> left =
            bending_gradient(both * P_right, H2_even - H2_odd, Q_even - Q_odd, bending);
        const Gradient<V> even = {right.A + left.A, right.B + left.B, right.C + left.C};
        const Gradient<V> odd = {right.A - left.A, right.B - left.B, right.C - left.C};
        M00 += even.A;
        M01 += t * odd.A + even.B;
        M02 += t2 * even.A + (2.0 * t) * odd.B;
        M12 += (t2 * t) * odd.A + (3.0 * t2) * even.B + (2.0 * t) * odd.C;
        M22 += (t2 * t2) * even.A + (4.0 * t2 * t) * odd.B + (4.0 * t2) * even.C;
        C0 += even.C;
    }
    const V M11 = M02 + C0;
    Parabola<V> f;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        f.c[0][i] = M00 * e.c[0][i] + M01 * e.c[1][i] + M02 * e.c[2][i];
        f.c[1][i] = M01 * e.c[0][i] + M11 * e.c[1][i] + M12 * e.c[2][i];
        f.c[2][i] = M02 * e.c[0][i] + M12 * e.c[1][i] + M22 * e.c[2][i];
    }
    return f;
}

// Symmetric 9x9 matrix on the coefficients of the parabola, packed by rows of the upper triangle.
inline constexpr int kPacked = 45;

constexpr int packed(int row, int column) {
    return row <= column ? row * 9 - row * (row - 1) / 2 + column - row : packed(column, row);
}

template <class V>
struct Hessian {
    V pp[3][3], ph[3][3], hh[3][3];  // ph: row p, column h
};

// Second derivatives of the energy density with respect to p and h.
template <class V>
TAUTWIRE_INLINE Hessian<V> energy_hessian(const V (&p)[3], const V (&h)[3], V half_axial, V bending) {
    const V P = dot(p, p), H = dot(h, h), Q = dot(p, h);
    const V i1 = 1.0 / P, i2 = i1 * i1, k = bending * i2;
    const V k_P = k * i1 * (3.0 * Q * Q * i1 - 2.0 * H);
    const V k_PP = 6.0 * k * i2 * (H - 2.0 * Q * Q * i1);
    const V k_PQ = 6.0 * k * Q * i2, k_PH = -2.0 * k * i1, k_QQ = -2.0 * k * i1;
    const V k_Q = -2.0 * k * Q * i1;
    const V round = half_axial * (P - 1.0) + k_P;
    Hessian<V> out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.pp[i][j] = 2.0 * (half_axial + k_PP) * p[i] * p[j] +
                           k_PQ * (p[i] * h[j] + h[i] * p[j]) + 0.5 * k_QQ * h[i] * h[j];
            out.ph[i][j] = 2.0 * k_PH * p[i] * h[j] + k_PQ * p[i] * p[j] + 0.5 * k_QQ * h[i] * p[j];
            out.hh[i][j] = 0.5 * k_QQ * p[i] * p[j];
        }
        out.pp[i][i] += round;
        out.ph[i][i] += 0.5 * k_Q;
        out.hh[i][i] += k;
    }
    return out;
}

// Tangent stiffness per length, packed.
template <class V>
void elastic_tangent(const Parabola<V>& e, const Stiffness<V>& stiffness, V (&out)[kPacked]) {
    for (V& entry : out) entry = broadcast<V>(0.0);
    for (int point = -2; point <= 2; ++point) {
        const int pair = point < 0 ? -point : point;
        const double t = point < 0 ? -kPoint[pair] : kPoint[pair];
        const double in_p[3] = {1.0, t, t * t}, in_h[3] = {0.0, 1.0, 2.0 * t};
        V p[3], h[3];
        for (int i = 0; i < 3; ++i) {
            p[i] = e.c[0][i] + t * (e.c[1][i] + t * e.c[2][i]);
            h[i] = e.c[1][i] + 2.0 * t * e.c[2][i];
        }
        const Hessian<V> second =
            energy_hessian(p, h, kWeight[pair] * stiffness.half_axial, kWeight[pair] * stiffness.bending);
        for (int row = 0; row < 9; ++row)
            for (int column = row; column < 9; ++column) {
                const int m = row / 3, i = row % 3, n = column / 3, j = column % 3;
                out[packed(row, column)] +=
                    in_p[m] * in_p[n] * second.pp[i][j] + in_p[m] * in_h[n] * second.ph[i][j] +
                    in_h[m] * in_p[n] * second.ph[j][i] + in_h[m] * in_h[n] * second.hh[i][j];
            }
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
