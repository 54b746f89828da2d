// ANCF cable element on lanes: elastic force and tangent (paper eqs. 4 to 6).
//
// With t in [-1, 1] along the element of unstrained length L, d = (r2 - r1)/L, sum = r1' + r2' - 2 d
// and difference = r1' - r2', the cubic Hermite interpolation reads
//
//     p = r'    = d + a sum - b difference,   a = (3 t^2 - 1)/4,  b = t/2
//     s = L r'' = 3 t sum - difference
//
// The energy per length depends on P = p.p, S = s.s and R = p.s only:
//
//     psi = EA/8 (P - 1)^2 + k/2 (S/P^2 - R^2/P^3),   k = EI/L^2
//
// so its gradient is A p + B s with respect to p and B p + C s with respect to s.
#pragma once

#include "simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Five-point Gauss-Legendre rule: the middle, then two symmetric pairs; weights sum to 1.
inline constexpr double kPoint[3] = {0.0, 0.53846931010568309, 0.90617984593866399};
inline constexpr double kWeight[3] = {0.28444444444444444, 0.23931433524968324, 0.11846344252809454};

template <class V>
struct Stiffness {
    V axial;    // EA
    V bending;  // EI / L^2
};

// Element coordinates, or their conjugate forces, on the basis (d, sum, difference).
template <class V>
struct Basis {
    V d[3], sum[3], difference[3];
};

template <class V>
TAUTWIRE_INLINE V dot(const V (&a)[3], const V (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// A, B and C at one point; `scaled` contains the quadrature weight.
template <class V>
struct Gradient {
    V A, B, C;
};

template <class V>
TAUTWIRE_INLINE Gradient<V> energy_gradient(V P, V S, V R, Stiffness<V> scaled) {
    const V inverse = 1.0 / P;
    const V C = scaled.bending * inverse * inverse;
    const V B = -R * inverse * C;
    const V A = 0.5 * scaled.axial * (P - 1.0) - inverse * (2.0 * S * C + 3.0 * R * B);
    return {A, B, C};
}

// Inner products of the basis vectors, or a symmetric matrix on (d, sum, difference).
template <class V>
struct Symmetric {
    V dd, ds, de, ss, se, ee;  // e: difference
};

// Nodal forces of the elastic energy divided by L, on the basis.
//
// As p and s are combinations of the three basis vectors, so is the force: its coefficients are
// sums of A, B and C over the points, and P, S and R are quadratic in the coefficients of p and s.
// Points at t and -t share the even and odd parts of everything.
template <class V>
TAUTWIRE_INLINE Basis<V> elastic_force(const Basis<V>& e, Stiffness<V> stiffness) {
    const Symmetric<V> g = {dot(e.d, e.d),     dot(e.d, e.sum),          dot(e.d, e.difference),
                            dot(e.sum, e.sum), dot(e.sum, e.difference), dot(e.difference, e.difference)};
    const Gradient<V> middle =
        energy_gradient(g.dd - 0.5 * g.ds + 0.0625 * g.ss, g.ee, 0.25 * g.se - g.de,
                        {kWeight[0] * stiffness.axial, kWeight[0] * stiffness.bending});
    Symmetric<V> m = {middle.A,          -0.25 * middle.A, -middle.B,
                      0.0625 * middle.A, 0.25 * middle.B,  middle.C};
    TAUTWIRE_UNROLL
    for (int pair = 1; pair < 3; ++pair) {
        const double t = kPoint[pair], a = 0.75 * t * t - 0.25, b = 0.5 * t, c = 3.0 * t;
        const V P_even = g.dd + (2.0 * a) * g.ds + (a * a) * g.ss + (b * b) * g.ee;
        const V P_odd = (-2.0 * b) * (g.de + a * g.se);
        const V S_even = (c * c) * g.ss + g.ee, S_odd = (-2.0 * c) * g.se;
        const V R_even = -g.de - (a + b * c) * g.se;
        const V R_odd = c * g.ds + (c * a) * g.ss + b * g.ee;
        const Stiffness<V> scaled = {kWeight[pair] * stiffness.axial,
                                     kWeight[pair] * stiffness.bending};
        const Gradient<V> right =
            energy_gradient(P_even + P_odd, S_even + S_odd, R_even + R_odd, scaled);
        const Gradient<V> left =
            energy_gradient(P_even - P_odd, S_even - S_odd, R_even - R_odd, scaled);
        const Gradient<V> even = {right.A + left.A, right.B + left.B, right.C + left.C};
        const Gradient<V> odd = {right.A - left.A, right.B - left.B, right.C - left.C};
        m.dd += even.A;
        m.ds += a * even.A + c * odd.B;
        m.de -= b * odd.A + even.B;
        m.ss += (a * a) * even.A + (2.0 * a * c) * odd.B + (c * c) * even.C;
        m.se -= (a * b) * odd.A + (a + b * c) * even.B + c * odd.C;
        m.ee += (b * b) * even.A + (2.0 * b) * odd.B + even.C;
    }
    Basis<V> f;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        f.d[i] = m.dd * e.d[i] + m.ds * e.sum[i] + m.de * e.difference[i];
        f.sum[i] = m.ds * e.d[i] + m.ss * e.sum[i] + m.se * e.difference[i];
        f.difference[i] = m.de * e.d[i] + m.se * e.sum[i] + m.ee * e.difference[i];
    }
    return f;
}

// Symmetric 9x9 matrix on the basis (d, sum, difference), packed by rows of the upper triangle.
inline constexpr int kPacked = 45;

constexpr int packed(int row, int column) {
    return row <= column ? row * 9 - row * (row - 1) / 2 + column - row : packed(column, row);
}

template <class V>
struct Hessian {
    V pp[3][3], ps[3][3], ss[3][3];  // ps: row p, column s
};

// Second derivatives of the energy density with respect to p and s.
template <class V>
TAUTWIRE_INLINE Hessian<V> energy_hessian(const V (&p)[3], const V (&s)[3], Stiffness<V> scaled) {
    const V P = dot(p, p), S = dot(s, s), R = dot(p, s);
    const V i1 = 1.0 / P, i2 = i1 * i1, k = scaled.bending * i2;
    const V k_P = -2.0 * k * S * i1 + 3.0 * k * R * R * i2;
    const V k_PP = 6.0 * k * S * i2 - 12.0 * k * R * R * i2 * i1;
    const V k_PR = 6.0 * k * R * i2, k_PS = -2.0 * k * i1, k_RR = -2.0 * k * i1;
    const V k_R = -2.0 * k * R * i1;
    const V round = 0.5 * scaled.axial * (P - 1.0) + k_P;
    Hessian<V> h;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            h.pp[i][j] = (scaled.axial + 2.0 * k_PP) * p[i] * p[j] +
                         k_PR * (p[i] * s[j] + s[i] * p[j]) + 0.5 * k_RR * s[i] * s[j];
            h.ps[i][j] = 2.0 * k_PS * p[i] * s[j] + k_PR * p[i] * p[j] + 0.5 * k_RR * s[i] * p[j];
            h.ss[i][j] = 0.5 * k_RR * p[i] * p[j];
        }
        h.pp[i][i] += round;
        h.ps[i][i] += 0.5 * k_R;
        h.ss[i][i] += k;
    }
    return h;
}

// Tangent stiffness divided by L, packed.
template <class V>
void elastic_tangent(const Basis<V>& e, Stiffness<V> stiffness, V (&out)[kPacked]) {
    for (V& entry : out) entry = broadcast<V>(0.0);
    for (int point = -2; point <= 2; ++point) {
        const int pair = point < 0 ? -point : point;
        const double t = point < 0 ? -kPoint[pair] : kPoint[pair];
        // Coefficients of p and s on (d, sum, difference).
        const double cp[3] = {1.0, 0.75 * t * t - 0.25, -0.5 * t}, cs[3] = {0.0, 3.0 * t, -1.0};
        V p[3], s[3];
        for (int i = 0; i < 3; ++i) {
            p[i] = e.d[i] + cp[1] * e.sum[i] + cp[2] * e.difference[i];
            s[i] = cs[1] * e.sum[i] + cs[2] * e.difference[i];
        }
        const Hessian<V> h = energy_hessian(
            p, s, {kWeight[pair] * stiffness.axial, kWeight[pair] * stiffness.bending});
        for (int row = 0; row < 9; ++row) {
            for (int column = row; column < 9; ++column) {
                const int m = row / 3, i = row % 3, n = column / 3, j = column % 3;
                out[packed(row, column)] += cp[m] * cp[n] * h.pp[i][j] + cp[m] * cs[n] * h.ps[i][j] +
                                            cs[m] * cp[n] * h.ps[j][i] + cs[m] * cs[n] * h.ss[i][j];
            }
        }
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
