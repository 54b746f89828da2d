// One iteration of a time step: residual and forward elimination in one sweep along the line,
// backward substitution and update of the accelerations in a second one.
//
// The state is kept as q_p, v_p and a with q = q_p + to_position a, v = v_p + to_velocity a. After
// an accepted step q_p and v_p still belong to it; the first sweep of the next step moves them on.
#pragma once

#include "assembly.hpp"
#include "preconditioner.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Axial force of droppers; they carry tension only.
TAUTWIRE_INLINE Doubles dropper_force(const Hanger& hanger, Doubles length, Doubles rate) {
    return maximum(broadcast<Doubles>(0.0),
                   hanger.stiffness * (length - hanger.length) + hanger.damping * rate);
}

struct Coefficients {
    double time_step, to_velocity, to_position;  // dt, gamma dt, beta dt^2
};

// Coordinates, velocities and what the mass acts on, a + (1 + alpha) a_R v, of the nodes of a row.
struct Motion {
    Row q, v, s;
};

class Sweeps {
public:
    Sweeps(const LineData& data, double weight, const Coefficients& coefficients)
        : line(data, weight), c(coefficients), q_p(line.layout.rows), v_p(line.layout.rows),
          a(line.layout.rows), known(line.layout.rows), damping_(line.layout.rows) {
        q_p.copy_from(line.position);
        known.copy_from(line.load);
        for (int row = 0; row < line.layout.rows; ++row) set_damping(row);
    }

    Line line;
    Coefficients c;
    Buffer<Row> q_p, v_p, a;
    Buffer<Row> known;  // forces known at the start of a step

    // Eliminate the residual of the present iterate. With kPredict the state is first moved on to
    // the next step with unchanged acceleration, and the preconditioner turned to it.
    template <bool kPredict, class P>
    void eliminate(P& preconditioner);

    // Substitute back and update the accelerations; return the largest increment of a coordinate,
    // NaN when the state is not finite.
    template <class P>
    double substitute(P& preconditioner);

    // Move on to the next step with unchanged acceleration.
    void predict() {
        for (int row = 0; row < line.layout.rows; ++row) motion<true>(row, &q_p[row], &v_p[row]);
    }

    // Nodal inertia forces M a, row by row from the left of each segment.
    void inertia(Buffer<Row>& out) const;

private:
    using Forces = Doubles[2][6];

    void set_damping(int row);
    template <bool kPredict>
    TAUTWIRE_INLINE Motion motion(int row, Row* q_store, Row* v_store) const;
    TAUTWIRE_INLINE void add_wires(int row, const Motion& left, const Motion& right, Forces& on_left,
                                   Forces& on_right) const;
    TAUTWIRE_INLINE static void add_inertia(const Element& element, const Doubles* left,
                                            const Doubles* right, Doubles* on_left, Doubles* on_right);
    TAUTWIRE_INLINE void add_hangers(const Hanger& hanger, const Motion& at, Forces& r) const;
    TAUTWIRE_INLINE void add_supports(const Support& support, const Motion& at, Forces& r) const;
    static Motion wrap(const Motion& first, const Motion& last);

    struct Damping {
        Floats k[kPacked];  // b_R K0 on the basis (d, sum, difference), both wires
    };
    Buffer<Damping> damping_;
};

inline void Sweeps::set_damping(int row) {
    Doubles tangent[2][kPacked];
    for (int wire = 0; wire < 2; ++wire) {
        const Element& element = line.element[2 * row + wire];
        Doubles left[6], right[6];
        element_nodes(line, line.position, row, wire, left, right);
        elastic_tangent(basis_of(left, right, element.inverse_length), element.stiffness, tangent[wire]);
    }
    for (int i = 0; i < kPacked; ++i)
        damping_[row].k[i] = join(line.damping_stiffness * tangent[0][i], line.damping_stiffness * tangent[1][i]);
}

template <bool kPredict>
TAUTWIRE_INLINE Motion Sweeps::motion(int row, Row* q_store, Row* v_store) const {
    Motion out;
    const double dt = c.time_step;
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            const Doubles acceleration = a[row][wire][i];
            Doubles q = q_p[row][wire][i], v = v_p[row][wire][i];
            if constexpr (kPredict) {
                // q_n + dt v_n + dt^2 (1/2 - beta) a_n and v_n + dt (1 - gamma) a_n
                q += dt * v + (dt * c.to_velocity + 0.5 * dt * dt) * acceleration;
                v += dt * acceleration;
                if (q_store) {
                    (*q_store)[wire][i] = q;
                    (*v_store)[wire][i] = v;
                }
            }
            out.q[wire][i] = q + c.to_position * acceleration;
            out.v[wire][i] = v + c.to_velocity * acceleration;
            out.s[wire][i] = acceleration + line.damping_mass * out.v[wire][i];
        }
    return out;
}

// Forces on the two ends of the elements behind a row: minus elastic, damping and inertia forces.
TAUTWIRE_INLINE void Sweeps::add_wires(
    int row, const Motion& left, const Motion& right, Forces& on_left, Forces& on_right) const {
    Basis<Doubles> f[2], rate[2];
    for (int wire = 0; wire < 2; ++wire) {
        const Element& element = line.element[2 * row + wire];
        f[wire] = elastic_force(
            basis_of(left.q[wire], right.q[wire], element.inverse_length), element.stiffness);
        rate[wire] = basis_of(left.v[wire], right.v[wire], element.inverse_length);
    }
    Floats x[9], y[9];
    for (int i = 0; i < 3; ++i) {
        x[i] = join(rate[0].d[i], rate[1].d[i]);
        x[3 + i] = join(rate[0].sum[i], rate[1].sum[i]);
        x[6 + i] = join(rate[0].difference[i], rate[1].difference[i]);
    }
    const Floats* k = damping_[row].k;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 9; ++i) y[i] = k[packed(i, i)] * x[i];
    TAUTWIRE_UNROLL
    for (int i = 0; i < 9; ++i)
        TAUTWIRE_UNROLL
        for (int j = i + 1; j < 9; ++j) {
            y[i] += k[packed(i, j)] * x[j];
            y[j] += k[packed(i, j)] * x[i];
        }
    for (int wire = 0; wire < 2; ++wire) {
        const Element& element = line.element[2 * row + wire];
        for (int i = 0; i < 3; ++i) {
            const Doubles sum = f[wire].sum[i] + widen(y[3 + i], wire);
            const Doubles difference = f[wire].difference[i] + widen(y[6 + i], wire);
            const Doubles along = f[wire].d[i] + widen(y[i], wire) - 2.0 * sum;
            on_left[wire][i] += along;
            on_right[wire][i] -= along;
            on_left[wire][3 + i] -= element.length * (sum + difference);
            on_right[wire][3 + i] -= element.length * (sum - difference);
        }
        add_inertia(element, left.s[wire], right.s[wire], on_left[wire], on_right[wire]);
    }
}

// Subtract the consistent mass times (s1, s1', s2, s2'), split into parts that are even and odd
// under exchange of the ends.
TAUTWIRE_INLINE void Sweeps::add_inertia(const Element& element, const Doubles* left,
                                         const Doubles* right, Doubles* on_left, Doubles* on_right) {
    const Doubles m = element.mass, slope = m * element.length;
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) {
        const Doubles sum = left[i] + right[i], difference = left[i] - right[i];
        const Doubles slope_sum = element.length * (left[3 + i] + right[3 + i]);
        const Doubles slope_difference = element.length * (left[3 + i] - right[3 + i]);
        const Doubles force_even = 105.0 * sum + 17.5 * slope_difference;
        const Doubles force_odd = 51.0 * difference + 4.5 * slope_sum;
        const Doubles moment_even = 4.5 * difference + 0.5 * slope_sum;
        const Doubles moment_odd = 17.5 * sum + 3.5 * slope_difference;
        on_left[i] -= m * (force_even + force_odd);
        on_right[i] -= m * (force_even - force_odd);
        on_left[3 + i] -= slope * (moment_even + moment_odd);
        on_right[3 + i] -= slope * (moment_even - moment_odd);
    }
}

TAUTWIRE_INLINE void Sweeps::add_hangers(const Hanger& hanger, const Motion& at, Forces& r) const {
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
}

TAUTWIRE_INLINE void Sweeps::add_supports(const Support& support, const Motion& at, Forces& r) const {
    Doubles t[3];
    for (int i = 0; i < 3; ++i) t[i] = at.q[0][i] - support.arm_end[i];
    const Doubles length = square_root(dot(t, t));
    const Doubles tension = support.arm_stiffness * (length - support.arm_length) / length;
    const Doubles* k = support.arm_damping;
    const Doubles* v = at.v[0];
    r[0][0] -= tension * t[0] + k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
    r[0][1] -= tension * t[1] + k[1] * v[0] + k[3] * v[1] + k[4] * v[2];
    r[0][2] -= tension * t[2] + k[2] * v[0] + k[4] * v[1] + k[5] * v[2];
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            r[wire][i] -= support.spring_stiffness[wire][i] * (at.q[wire][i] - support.spring_free[wire][i]) +
                          support.spring_damping[wire][i] * at.v[wire][i];
            r[wire][i] *= support.free[wire][i];
        }
}

// The row behind the last one: the next segment's first; in the last lane, which has no next
// segment, any regular node.
inline Motion Sweeps::wrap(const Motion& first, const Motion& last) {
    Motion out;
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            out.q[wire][i] = to_previous_segment(first.q[wire][i]);
            out.v[wire][i] = to_previous_segment(first.v[wire][i]);
            out.s[wire][i] = to_previous_segment(first.s[wire][i]);
            out.q[wire][i][kLanes - 1] = last.q[wire][i][kLanes - 1] + (i == 0 ? 1.0 : 0.0);
        }
    return out;
}

template <bool kPredict, class P>
void Sweeps::eliminate(P& preconditioner) {
    const int rows = line.layout.rows;
    const Motion last = motion<kPredict>(rows - 1, nullptr, nullptr);
    const Motion behind = wrap(motion<kPredict>(0, nullptr, nullptr), last);
    Forces carry = {}, next = {};
    add_wires(rows - 1, last, behind, carry, next);  // only what acts on the next segment is kept
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) carry[wire][i] = to_next_segment(next[wire][i]);

    Motion nodes[2];
    nodes[0] = motion<kPredict>(0, &q_p[0], &v_p[0]);
    for (int row = 0; row < rows; ++row) {
        const Motion& here = nodes[row & 1];
        Motion& right = nodes[~row & 1];
        right = row + 1 < rows ? motion<kPredict>(row + 1, &q_p[row + 1], &v_p[row + 1]) : behind;
        Forces r;
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                r[wire][i] = known[row][wire][i] + carry[wire][i];
                if (i < 3) r[wire][i] -= line.node_mass[2 * row + wire] * here.s[wire][i];
                carry[wire][i] = broadcast<Doubles>(0.0);
            }
        add_wires(row, here, right, r, carry);
        if (line.hanger_of[row] >= 0) add_hangers(line.hangers[line.hanger_of[row]], here, r);
        if (line.support_of[row] >= 0) add_supports(line.supports[line.support_of[row]], here, r);
        if constexpr (kPredict) preconditioner.set_rotation(row, here.q[0] + 3, here.q[1] + 3);
        preconditioner.eliminate(row, r);
    }
    preconditioner.chain().finish_elimination();
}

inline void Sweeps::inertia(Buffer<Row>& out) const {
    const int rows = line.layout.rows;
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i)
                out[row][wire][i] = i < 3 ? line.node_mass[2 * row + wire] * a[row][wire][i] : broadcast<Doubles>(0.0);
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire) {
            Doubles left[6], right[6], on_left[6] = {}, on_right[6] = {};
            element_nodes(line, a, row, wire, left, right);
            add_inertia(line.element[2 * row + wire], left, right, on_left, on_right);
            const int behind = row + 1 < rows ? row + 1 : 0;
            for (int i = 0; i < 6; ++i) {
                out[row][wire][i] -= on_left[i];
                out[behind][wire][i] -= behind ? on_right[i] : to_next_segment(on_right[i]);
            }
        }
}

template <class P>
double Sweeps::substitute(P& preconditioner) {
    using V = typename P::Vector;
    V largest = broadcast<V>(0.0), total = largest;
    preconditioner.chain().begin_substitution();
    for (int row = line.layout.rows - 1; row >= 0; --row) {
        Forces x;
        preconditioner.substitute(row, x, largest, total);
        const int support = line.support_of[row];
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                if (support >= 0) x[wire][i] *= line.supports[support].free[wire][i];
                a[row][wire][i] += x[wire][i];
            }
    }
    double size = 0.0, sum = 0.0;
    for (int lane = 0; lane < kLanesOf<V>; ++lane) {
        size = largest[lane] > size ? largest[lane] : size;
        sum += total[lane];
    }
    return std::isfinite(sum) ? c.to_position * size : sum - sum;
}

}  // namespace tautwire::TAUTWIRE_ISA
