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

#include "simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Five-point Gauss-Legendre rule: the middle, then two symmetric pairs; weights sum to 1.
inline constexpr double kPoint[3] = {0.0, 0.53846931010568309, 0.90617984593866399};
inline constexpr double kWeight[3] = {0.28444444444444444, 0.23931433524968324, 0.11846344252809454};

template <class V>
struct Stiffness {
    V axial;    // EA
    V bending;  // 4 EI / L^2

    TAUTWIRE_INLINE Stiffness weighted(int point) const {
        return {kWeight[point] * axial, kWeight[point] * bending};
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

// A, B and C at a point; `weighted` contains the quadrature weight.
template <class V>
TAUTWIRE_INLINE Gradient<V> energy_gradient(V P, V H, V Q, Stiffness<V> weighted) {
    const V inverse = 1.0 / P;
    const V C = weighted.bending * inverse * inverse;
    const V B = -Q * inverse * C;
    const V A = 0.5 * weighted.axial * (P - 1.0) - inverse * (2.0 * H * C + 3.0 * Q * B);
    return {A, B, C};
}

// Forces of the elastic energy per length on the coefficients of the parabola.
//
// They are combinations of the coefficients themselves, with factors M summed over the points, and
// P, H and Q are polynomials. Points at t and -t share even and odd parts of everything.
template <class V>
TAUTWIRE_INLINE Parabola<V> elastic_force(const Parabola<V>& e, Stiffness<V> stiffness) {
    const V P0 = dot(e.c[0], e.c[0]), P1 = 2.0 * dot(e.c[0], e.c[1]);
    const V H0 = dot(e.c[1], e.c[1]), P2 = H0 + 2.0 * dot(e.c[0], e.c[2]);
    const V P3 = 2.0 * dot(e.c[1], e.c[2]), P4 = dot(e.c[2], e.c[2]);
    const Gradient<V> middle = energy_gradient(P0, H0, 0.5 * P1, stiffness.weighted(0));
    V M00 = middle.A, M01 = middle.B, C0 = middle.C;
    V M02 = broadcast<V>(0.0), M12 = M02, M22 = M02;
    TAUTWIRE_UNROLL
    for (int pair = 1; pair < 3; ++pair) {
        const double t = kPoint[pair], t2 = t * t;
        const V P_even = P0 + t2 * (P2 + t2 * P4), P_odd = t * (P1 + t2 * P3);
        const V H_even = H0 + (4.0 * t2) * P4, H_odd = (2.0 * t) * P3;
        const V Q_even = 0.5 * P1 + (1.5 * t2) * P3, Q_odd = t * (P2 + (2.0 * t2) * P4);
        const Stiffness<V> weighted = stiffness.weighted(pair);
        const Gradient<V> right =
            energy_gradient(P_even + P_odd, H_even + H_odd, Q_even + Q_odd, weighted);
        const Gradient<V> left =
            energy_gradient(P_even - P_odd, H_even - H_odd, Q_even - Q_odd, weighted);
        const Gradient<V> even = {right.A + left.A, right.B + left.B, right.C + left.C};
        const Gradient<V> odd = {right.A - left.A, right.B - left.B, right.C - left.C};
        M00 += even.A;
        M01 += t * odd.A + even.B;
        M02 += t2 * even.A + (2.0 * t) * odd.B;
        M12 += (t2 * t) * odd.A + (3.0 * t2) * even.B + (2.0 * t) * odd.C;
        M22 += (t2 * t2) * even.A + (4.0 * t2 * t) * odd.B + (4.0 * t2) * even.C;
        C0 += even.C;
    }
    Parabola<V> f;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        f.c[0][i] = M00 * e.c[0][i] + M01 * e.c[1][i] + M02 * e.c[2][i];
        f.c[1][i] = M01 * e.c[0][i] + (M02 + C0) * e.c[1][i] + M12 * e.c[2][i];
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
TAUTWIRE_INLINE Hessian<V> energy_hessian(const V (&p)[3], const V (&h)[3], Stiffness<V> weighted) {
    const V P = dot(p, p), H = dot(h, h), Q = dot(p, h);
    const V i1 = 1.0 / P, i2 = i1 * i1, k = weighted.bending * i2;
    const V k_P = k * i1 * (3.0 * Q * Q * i1 - 2.0 * H);
    const V k_PP = 6.0 * k * i2 * (H - 2.0 * Q * Q * i1);
    const V k_PQ = 6.0 * k * Q * i2, k_PH = -2.0 * k * i1, k_QQ = -2.0 * k * i1;
    const V k_Q = -2.0 * k * Q * i1;
    const V round = 0.5 * weighted.axial * (P - 1.0) + k_P;
    Hessian<V> out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.pp[i][j] = (weighted.axial + 2.0 * k_PP) * p[i] * p[j] +
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
void elastic_tangent(const Parabola<V>& e, Stiffness<V> stiffness, V (&out)[kPacked]) {
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
        const Hessian<V> second = energy_hessian(p, h, stiffness.weighted(pair));
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
