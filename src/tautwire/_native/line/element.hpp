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

// The type of a lane: constants must have it, as double precision is not mixed with single.
template <class V>
using Number = std::decay_t<decltype(std::declval<V&>()[0])>;

// Coefficients of P - 1, and H where t = 0; those of H and Q follow from them. Made in double precision.
template <class V>
struct Strain {
    V E[5], H;
};

template <class V>
TAUTWIRE_INLINE Strain<V> strain_of(const Parabola<V>& e) {
    const V H = dot(e.c[1], e.c[1]);
    return {{dot(e.c[0], e.c[0]) - 1.0, 2.0 * dot(e.c[0], e.c[1]), H + 2.0 * dot(e.c[0], e.c[2]),
             2.0 * dot(e.c[1], e.c[2]), dot(e.c[2], e.c[2])},
            H};
}

// The forces on the coefficients are combinations of the coefficients themselves: with a symmetric
// matrix of averages over the element of A t^0 to A t^4, and of the like for B and C.
template <class V>
struct Moments {
    V m00, m01, m02, m11, m12, m22;
};

// Moments of the axial part, EA/2 (P - 1), and of the linear part of bending, C where P = 1: they follow
// from the averages of powers of t, exactly as the rule has them.
template <class V>
TAUTWIRE_INLINE Moments<V> leading_moments(const Strain<V>& e, const Stiffness<V>& stiffness) {
    const V half = stiffness.half_axial;
    const V n0 = half * e.E[0], n1 = half * e.E[1], n2 = half * e.E[2], n3 = half * e.E[3], n4 = half * e.E[4];
    const V second = (1.0 / 3.0) * n0 + (1.0 / 5.0) * n2 + (1.0 / 7.0) * n4;
    return {n0 + (1.0 / 3.0) * n2 + (1.0 / 5.0) * n4,
            (1.0 / 3.0) * n1 + (1.0 / 5.0) * n3,
            second,
            second + stiffness.bending,
            (1.0 / 5.0) * n1 + (1.0 / 7.0) * n3,
            (1.0 / 5.0) * n0 + (1.0 / 7.0) * n2 + (1.0 / 9.0) * n4 + (4.0 / 3.0) * stiffness.bending};
}

// A and B of the bending part at a point, and by how much C differs from that where P = 1.
template <class V>
struct Gradient {
    V A, B, C;
};

// At a point where P - 1 is `excess`; H2 is 2 H, inverse 1/P.
template <class V>
TAUTWIRE_INLINE Gradient<V> bending_gradient(V excess, V inverse, V H2, V Q, V bending) {
    using T = Number<V>;
    const V R = Q * inverse, C = bending * (inverse * inverse);
    return {-(C * inverse) * (H2 - T(3.0) * (Q * R)), -R * C, -C * (excess * (excess + T(2.0)))};
}

// Moments of the rest of bending, summed over the points. Points at t and -t share even and odd parts of
// everything.
template <class V>
TAUTWIRE_INLINE Moments<V> bending_moments(const Strain<V>& e, V stiffness) {
    using T = Number<V>;
    const V E1 = e.E[1], E2 = e.E[2], E3 = e.E[3], E4 = e.E[4], none = broadcast<V>(0.0);
    const Gradient<V> middle = bending_gradient(
        e.E[0], T(1.0) / (e.E[0] + T(1.0)), e.H + e.H, T(0.5) * E1, T(kWeight[0]) * stiffness);
    Moments<V> m = {middle.A, middle.B, none, middle.C, none, none};
    TAUTWIRE_UNROLL
    for (int pair = 1; pair < 3; ++pair) {
        const T t = T(kPoint[pair]), t2 = t * t;
        const V E_even = e.E[0] + t2 * (E2 + t2 * E4), E_odd = t * (E1 + t2 * E3);
        const V H2_even = T(2.0) * e.H + (T(8.0) * t2) * E4, H2_odd = (T(4.0) * t) * E3;
        const V Q_even = T(0.5) * E1 + (T(1.5) * t2) * E3, Q_odd = t * (E2 + (T(2.0) * t2) * E4);
        const V E_right = E_even + E_odd, E_left = E_even - E_odd;
        const V P_right = E_right + T(1.0), P_left = E_left + T(1.0);
        const V both = T(1.0) / (P_right * P_left), bending = T(kWeight[pair]) * stiffness;
        const Gradient<V> right =
            bending_gradient(E_right, both * P_left, H2_even + H2_odd, Q_even + Q_odd, bending);
        const Gradient<V> left =
            bending_gradient(E_left, both * P_right, H2_even - H2_odd, Q_even - Q_odd, bending);
        const Gradient<V> even = {right.A + left.A, right.B + left.B, right.C + left.C};
        const Gradient<V> odd = {right.A - left.A, right.B - left.B, right.C - left.C};
        m.m00 += even.A;
        m.m01 += t * odd.A + even.B;
        const V second = t2 * even.A + (T(2.0) * t) * odd.B;
        m.m02 += second;
        m.m11 += second + even.C;
        m.m12 += (t2 * t) * odd.A + (T(3.0) * t2) * even.B + (T(2.0) * t) * odd.C;
        m.m22 += (t2 * t2) * even.A + (T(4.0) * t2 * t) * odd.B + (T(4.0) * t2) * even.C;
    }
    return m;
}

template <class V>
TAUTWIRE_INLINE Moments<V> operator+(const Moments<V>& a, const Moments<V>& b) {
    return {a.m00 + b.m00, a.m01 + b.m01, a.m02 + b.m02, a.m11 + b.m11, a.m12 + b.m12, a.m22 + b.m22};
}

template <class V>
TAUTWIRE_INLINE Parabola<V> operator*(const Moments<V>& m, const Parabola<V>& e) {
    Parabola<V> f;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        f.c[0][i] = m.m00 * e.c[0][i] + m.m01 * e.c[1][i] + m.m02 * e.c[2][i];
        f.c[1][i] = m.m01 * e.c[0][i] + m.m11 * e.c[1][i] + m.m12 * e.c[2][i];
        f.c[2][i] = m.m02 * e.c[0][i] + m.m12 * e.c[1][i] + m.m22 * e.c[2][i];
    }
    return f;
}

// Forces of the elastic energy per length on the coefficients of the parabola.
template <class V>
TAUTWIRE_INLINE Parabola<V> elastic_force(const Parabola<V>& e, const Stiffness<V>& stiffness) {
    const Strain<V> strain = strain_of(e);
    return (leading_moments(strain, stiffness) + bending_moments(strain, stiffness.bending)) * e;
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
