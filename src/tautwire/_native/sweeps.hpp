// One iteration of a time step: residual and forward elimination in one sweep along the line,
// backward substitution and update of the accelerations in a second one.
//
// The state is kept as q_p, v_p and a with q = q_p + to_position a, v = v_p + to_velocity a. After
// an accepted step q_p and v_p still belong to it; the first sweep of the next step moves them on.
#pragma once

#include "assembly.hpp"
#include "forces.hpp"
#include "preconditioner.hpp"

namespace tautwire::TAUTWIRE_ISA {

struct Coefficients {
    double time_step, to_velocity, to_position;  // dt, gamma dt, beta dt^2
};

class Sweeps {
public:
    Sweeps(const LineData& data, double weight, const Coefficients& coefficients)
        : line(data, weight), c(coefficients), q_p(line.layout.rows), v_p(line.layout.rows),
          a(line.layout.rows), known(line.layout.rows), taut(line.hangers.size()),
          damping_(line.layout.rows) {
        q_p.copy_from(line.position);
        known.copy_from(line.load);
        for (int row = 0; row < line.layout.rows; ++row) set_damping(row);
    }

    Line line;
    Coefficients c;
    Buffer<Row> q_p, v_p, a;
    Buffer<Row> known;     // forces known at the start of a step
    Buffer<Doubles> taut;  // which droppers carried force at the last residual: 1 or 0

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
        Motion unused;
        for (int row = 0; row < line.layout.rows; ++row) move<true, true>(row, unused);
    }

    // Nodal inertia forces M a.
    void inertia(Buffer<Row>& out) const;

private:
    void set_damping(int row);
    template <bool kPredict, bool kStore>
    TAUTWIRE_INLINE void move(int row, Motion& out);
    TAUTWIRE_INLINE void wires(int row, const Motion& left, const Motion& right, Ends (&out)[2]) const;
    static void wrap(const Motion& first, const Motion& last, Motion& out);

    Buffer<Damping> damping_;
};

inline void Sweeps::set_damping(int row) {
    Doubles tangent[2][kPacked];
    for (int wire = 0; wire < 2; ++wire) {
        const Element& element = line.element[2 * row + wire];
        Doubles left[6], right[6];
        element_nodes(line, line.position, row, wire, left, right);
        elastic_tangent(
            parabola(left, right, element.inverse_length), element.stiffness, tangent[wire]);
    }
    for (int i = 0; i < kPacked; ++i)
        damping_[row].k[i] = join(line.damping_stiffness * tangent[0][i],
                                  line.damping_stiffness * tangent[1][i]);
}

// Form the motion of a row's nodes. With kPredict the state is moved on to the next step, in place
// when kStore is set.
template <bool kPredict, bool kStore>
TAUTWIRE_INLINE void Sweeps::move(int row, Motion& out) {
    const double dt = c.time_step, full = dt * c.to_velocity + 0.5 * dt * dt;
    TAUTWIRE_UNROLL
    for (int wire = 0; wire < 2; ++wire)
        TAUTWIRE_UNROLL
        for (int i = 0; i < 6; ++i) {
            const Doubles acceleration = a[row][wire][i];
            Doubles q = q_p[row][wire][i], v = v_p[row][wire][i];
            if constexpr (kPredict) {
                // q_n + dt v_n + dt^2 (1/2 - beta) a_n and v_n + dt (1 - gamma) a_n
                q += dt * v + full * acceleration;
                v += dt * acceleration;
                if constexpr (kStore) {
                    q_p[row][wire][i] = q;
                    v_p[row][wire][i] = v;
                }
            }
            v += c.to_velocity * acceleration;
            out.q[wire][i] = q + c.to_position * acceleration;
            out.v[wire][i] = v;
            out.s[wire][i] = acceleration + line.damping_mass * v;
        }
}

// Forces of the elements behind a row: minus elastic, damping and inertia forces.
TAUTWIRE_INLINE void Sweeps::wires(
    int row, const Motion& left, const Motion& right, Ends (&out)[2]) const {
    const Element* element = &line.element[2 * row];
    Parabola<Doubles> f[2], rate[2];
    for (int wire = 0; wire < 2; ++wire) {
        const Doubles inverse = element[wire].inverse_length;
        f[wire] = elastic_force(
            parabola(left.q[wire], right.q[wire], inverse), element[wire].stiffness);
        rate[wire] = parabola(left.v[wire], right.v[wire], inverse);
    }
    add_damping(damping_[row], rate, f);
    for (int wire = 0; wire < 2; ++wire)
        out[wire] = wire_forces(element[wire], f[wire], left.s[wire], right.s[wire]);
}

// The row behind the last one: the next segment's first; in the last lane, which has no next
// segment, any regular node.
inline void Sweeps::wrap(const Motion& first, const Motion& last, Motion& out) {
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            out.q[wire][i] = to_previous_segment(first.q[wire][i]);
            out.v[wire][i] = to_previous_segment(first.v[wire][i]);
            out.s[wire][i] = to_previous_segment(first.s[wire][i]);
            out.q[wire][i][kLanes - 1] = last.q[wire][i][kLanes - 1] + (i == 0 ? 1.0 : 0.0);
        }
}

template <bool kPredict, class P>
void Sweeps::eliminate(P& preconditioner) {
    const int rows = line.layout.rows;
    Motion nodes[2], behind;
    Ends ends[2];
    Row carry;
    move<kPredict, false>(0, nodes[0]);
    move<kPredict, false>(rows - 1, nodes[1]);
    wrap(nodes[0], nodes[1], behind);
    wires(rows - 1, nodes[1], behind, ends);  // the last elements act on the next segments
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) carry[wire][i] = to_next_segment(ends[wire].right[i]);

    move<kPredict, true>(0, nodes[0]);
    for (int row = 0; row < rows; ++row) {
        const Motion& here = nodes[row & 1];
        Motion& next = nodes[~row & 1];
        if (row + 1 < rows) move<kPredict, true>(row + 1, next);
        wires(row, here, row + 1 < rows ? next : behind, ends);
        Row r;
        TAUTWIRE_UNROLL
        for (int wire = 0; wire < 2; ++wire)
            TAUTWIRE_UNROLL
            for (int i = 0; i < 6; ++i) {
                r[wire][i] = known[row][wire][i] + (carry[wire][i] + ends[wire].left[i]);
                if (i < 3) r[wire][i] -= line.node_mass[2 * row + wire] * here.s[wire][i];
                carry[wire][i] = ends[wire].right[i];
            }
        const int hanger = line.hanger_of[row], support = line.support_of[row];
        if (hanger >= 0) taut[hanger] = add_hangers(line.hangers[hanger], here, r);
        if (support >= 0) add_supports(line.supports[support], here, r);
        if constexpr (kPredict) preconditioner.set_rotation(row, here.q[0] + 3, here.q[1] + 3);
        preconditioner.eliminate(row, r);
    }
    preconditioner.finish_elimination(taut);
}

inline void Sweeps::inertia(Buffer<Row>& out) const {
    const int rows = line.layout.rows;
    const Parabola<Doubles> none = {};
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i)
                out[row][wire][i] = i < 3 ? line.node_mass[2 * row + wire] * a[row][wire][i]
                                          : broadcast<Doubles>(0.0);
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire) {
            Doubles left[6], right[6];
            element_nodes(line, a, row, wire, left, right);
            const Ends ends = wire_forces(line.element[2 * row + wire], none, left, right);
            const int behind = row + 1 < rows ? row + 1 : 0;
            for (int i = 0; i < 6; ++i) {
                out[row][wire][i] -= ends.left[i];
                out[behind][wire][i] -= behind ? ends.right[i] : to_next_segment(ends.right[i]);
            }
        }
}

template <class P>
double Sweeps::substitute(P& preconditioner) {
    using V = typename P::Vector;
    V largest = broadcast<V>(0.0), total = largest;
    preconditioner.chain().begin_substitution();
    for (int row = line.layout.rows - 1; row >= 0; --row) {
        Row x;
        preconditioner.substitute(row, x, largest, total);
        const int support = line.support_of[row];
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                if (support >= 0) x[wire][i] *= line.supports[support].free[wire][i];
                a[row][wire][i] += x[wire][i];
            }
    }
    double sum = 0.0;
    for (int lane = 0; lane < kLanesOf<V>; ++lane) sum += total[lane];
    return std::isfinite(sum) ? c.to_position * largest_lane(largest) : sum - sum;
}

}  // namespace tautwire::TAUTWIRE_ISA
