// One iteration of a time step: residual and forward elimination in one sweep along the line,
// backward substitution and update of the accelerations in a second one.
//
// A state is kept as q_p, v_p and a with q = q_p + to_position a and v = v_p + to_velocity a. The
// first sweeps of a step read the state at its start and write the one at its end, so that a step
// can be dropped.
#pragma once

#include "assembly.hpp"
#include "forces.hpp"
#include "preconditioner.hpp"

namespace tautwire::TAUTWIRE_ISA {

// The wires at one instant; to_velocity and to_position belong to the step that led there.
struct WireState {
    explicit WireState(int rows) : q_p(rows), v_p(rows), a(rows) {}

    Buffer<Row> q_p, v_p, a;
    double to_velocity = 0.0, to_position = 0.0;
};

// Prediction with unchanged acceleration: q_p = q_p + dt v_p + a_to_q a, v_p = v_p + a_to_v a.
struct Prediction {
    double time_step = 0.0, a_to_q = 0.0, a_to_v = 0.0;
};

// A stretch of the contact wire within one segment.
struct Region {
    RowRange rows;
    int lane;
};

// Largest increments of the acceleration of a coordinate: anywhere, and outside some regions; NaN
// when the state is not finite.
struct Increment {
    double all, outside;
};

class Sweeps {
public:
    Sweeps(const LineData& data, double weight)
        : line(data, weight), known(line.layout.rows), taut(line.hangers.size()),
          states_{WireState(line.layout.rows), WireState(line.layout.rows)},
          damping_(line.layout.rows) {
        start().q_p.copy_from(line.position);
        known.copy_from(line.load);
        for (int row = 0; row < line.layout.rows; ++row) set_damping(row);
    }

    Line line;
    Buffer<Row> known;      // forces known at the start of a step
    Buffer<Doubles> taut;   // which droppers carried force at the last residual: 1 or 0
    Prediction prediction;  // of the step in progress

    WireState& start() { return states_[now_]; }
    const WireState& start() const { return states_[now_]; }
    WireState& end() { return states_[1 - now_]; }
    const WireState& end() const { return states_[1 - now_]; }

    // Begin a step of a size; end() is the state at its end from here on.
    void begin(const Scheme& scheme, double time_step) {
        const double dt = time_step;
        prediction = {dt, start().to_position + dt * start().to_velocity + dt * dt * (0.5 - scheme.beta),
                      start().to_velocity + dt * (1.0 - scheme.gamma)};
        end().to_velocity = scheme.gamma * dt;
        end().to_position = scheme.beta * dt * dt;
    }

    // Stiffen the wires for a time step; the known forces follow their loads.
    void set_time_step(double dt) {
        if (!line.depends_on(dt)) return;
        Buffer<Row> before(line.load.size());
        before.copy_from(line.load);
        line.set_time_step(dt);
        for (std::size_t row = 0; row < known.size(); ++row)
            for (int i = 0; i < 12; ++i) {
                Doubles& force = known[row][i / 6][i % 6];
                force = line.load[row][i / 6][i % 6] + (force - before[row][i / 6][i % 6]);
            }
    }

    // Make the end of the step the start of the next.
    void accept() { now_ = 1 - now_; }

    // Predict the end of the step.
    void predict() {
        Motion unused;
        for (int row = 0; row < line.layout.rows; ++row) move<true, true>(row, unused);
        end().a.copy_from(start().a);
    }

    // Eliminate the residual of the present iterate in a range of rows. With kFirst, in all rows,
    // that iterate is the prediction, which is made on the way, and the preconditioner is turned
    // to it.
    template <bool kFirst, class P>
    void eliminate(P& preconditioner, RowRange range);

    // Substitute back and update the accelerations.
    template <bool kFirst, class P>
    Increment substitute(P& preconditioner, RowRange range, const Region* apart, int count);

    // Nodal inertia forces M a at the end of the step.
    void inertia(Buffer<Row>& out) const;

private:
    void set_damping(int row);
    template <bool kFirst, bool kStore>
    TAUTWIRE_INLINE void move(int row, Motion& out);
    TAUTWIRE_INLINE void wires(int row, const Motion& left, const Motion& right, Ends (&out)[2]) const;
    static void wrap(const Motion& first, const Motion& last, Motion& out);

    WireState states_[2];
    int now_ = 0;
    Buffer<Damping> damping_;
};

inline void Sweeps::set_damping(int row) {
    constexpr int kSlot[9] = {6, 7, 8, 3, 4, 5, 9, 10, 11};  // r2, r1', r2' of (r1, r1', r2, r2')
    Doubles k[2][12][12];
    for (int wire = 0; wire < 2; ++wire) {
        const Element& element = line.element[2 * row + wire];
        Doubles left[6], right[6], tangent[kPacked];
        element_nodes(line, line.position, row, wire, left, right);
        elastic_tangent(
            parabola(left, right, element.inverse_length), element.stiffness, tangent);
        nodal_tangent(tangent, element, k[wire]);
    }
    for (int i = 0; i < 9; ++i)
        for (int j = i; j < 9; ++j)
            damping_[row].k[packed(i, j)] = join(line.damping_stiffness * k[0][kSlot[i]][kSlot[j]],
                                                 line.damping_stiffness * k[1][kSlot[i]][kSlot[j]]);
}

// Form the motion of a row's nodes. With kFirst it is predicted; kStore keeps the prediction.
template <bool kFirst, bool kStore>
TAUTWIRE_INLINE void Sweeps::move(int row, Motion& out) {
    const WireState& from = kFirst ? start() : end();
    WireState& to = end();
    Doubles slope_rate[2][3];
    TAUTWIRE_UNROLL
    for (int wire = 0; wire < 2; ++wire)
        TAUTWIRE_UNROLL
        for (int i = 0; i < 6; ++i) {
            const Doubles acceleration = from.a[row][wire][i];
            Doubles q = from.q_p[row][wire][i], v = from.v_p[row][wire][i];
            if constexpr (kFirst) {
                q += prediction.time_step * v + prediction.a_to_q * acceleration;
                v += prediction.a_to_v * acceleration;
                if constexpr (kStore) {
                    to.q_p[row][wire][i] = q;
                    to.v_p[row][wire][i] = v;
                }
            }
            v += to.to_velocity * acceleration;
            out.q[wire][i] = q + to.to_position * acceleration;
            out.s[wire][i] = acceleration + line.damping_mass * v;
            (i < 3 ? out.v[wire][i] : slope_rate[wire][i - 3]) = v;
        }
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) out.turn[i] = join(slope_rate[0][i], slope_rate[1][i]);
}

// Forces of the elements behind a row: minus elastic, damping and inertia forces.
TAUTWIRE_INLINE void Sweeps::wires(
    int row, const Motion& left, const Motion& right, Ends (&out)[2]) const {
    Floats damping[9];
    Doubles drag[2][9];
    damping_forces(damping_[row], left, right, damping);
    TAUTWIRE_UNROLL
    for (int i = 0; i < 9; ++i) {
        drag[0][i] = widen(damping[i], 0);
        drag[1][i] = widen(damping[i], 1);
    }
    for (int wire = 0; wire < 2; ++wire) {
        const Element& element = line.element[2 * row + wire];
        const Parabola<Doubles> f = elastic_force(
            parabola(left.q[wire], right.q[wire], element.inverse_length), element.stiffness);
        Ends ends = wire_forces(element, f, left.s[wire], right.s[wire]);
        TAUTWIRE_UNROLL
        for (int i = 0; i < 3; ++i) {
            ends.left[i] += drag[wire][i];
            ends.right[i] -= drag[wire][i];
            ends.left[3 + i] -= drag[wire][3 + i];
            ends.right[3 + i] -= drag[wire][6 + i];
        }
        out[wire] = ends;
    }
}

// The row behind the last one: the next segment's first; in the last lane, which has no next
// segment, any regular node.
inline void Sweeps::wrap(const Motion& first, const Motion& last, Motion& out) {
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            out.q[wire][i] = to_previous_segment(first.q[wire][i]);
            out.s[wire][i] = to_previous_segment(first.s[wire][i]);
            if (i < 3) out.v[wire][i] = to_previous_segment(first.v[wire][i]);
            out.q[wire][i][kLanes - 1] = last.q[wire][i][kLanes - 1] + (i == 0 ? 1.0 : 0.0);
        }
    for (int i = 0; i < 3; ++i) out.turn[i] = to_previous_segment(first.turn[i]);
}

template <bool kFirst, class P>
void Sweeps::eliminate(P& preconditioner, RowRange range) {
    const int rows = line.layout.rows, first = range.first;
    Motion nodes[2], behind;
    Ends ends[2];
    Row carry;
    if (first == 0 || range.last == rows - 1) {
        move<kFirst, false>(0, nodes[0]);
        move<kFirst, false>(rows - 1, nodes[1]);
        wrap(nodes[0], nodes[1], behind);
    }
    // What the elements before the first row do to it; those of the last row act on the next segment.
    if (first == 0) {
        wires(rows - 1, nodes[1], behind, ends);
    } else {
        move<kFirst, false>(first - 1, nodes[~first & 1]);
        move<kFirst, false>(first, nodes[first & 1]);
        wires(first - 1, nodes[~first & 1], nodes[first & 1], ends);
    }
    for (int wire = 0; wire < 2; ++wire)
        for (int i = 0; i < 6; ++i) {
            const Doubles right = ends[wire].right[i];
            carry[wire][i] = first == 0 ? to_next_segment(right) : right;
        }

    preconditioner.begin_elimination(range);
    if constexpr (kFirst) move<kFirst, true>(first, nodes[first & 1]);
    for (int row = first; row <= range.last; ++row) {
        const Motion& here = nodes[row & 1];
        Motion& next = nodes[~row & 1];
        if (row + 1 < rows) move<kFirst, true>(row + 1, next);
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
        if constexpr (kFirst) preconditioner.set_rotation(row, here.q[0] + 3, here.q[1] + 3);
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
                out[row][wire][i] = i < 3 ? line.node_mass[2 * row + wire] * end().a[row][wire][i]
                                          : broadcast<Doubles>(0.0);
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire) {
            Doubles left[6], right[6];
            element_nodes(line, end().a, row, wire, left, right);
            const Ends ends = wire_forces(line.element[2 * row + wire], none, left, right);
            const int behind = row + 1 < rows ? row + 1 : 0;
            for (int i = 0; i < 6; ++i) {
                out[row][wire][i] -= ends.left[i];
                out[behind][wire][i] -= behind ? ends.right[i] : to_next_segment(ends.right[i]);
            }
        }
}

template <bool kFirst, class P>
Increment Sweeps::substitute(P& preconditioner, RowRange range, const Region* apart, int count) {
    using V = typename P::Vector;
    V outside = broadcast<V>(0.0), total = outside;
    double inside = 0.0;
    preconditioner.chain().begin_substitution();
    for (int row = range.last; row >= range.first; --row) {
        Row x;
        V size;
        preconditioner.substitute(row, x, size, total);
        const int support = line.support_of[row];
        TAUTWIRE_UNROLL
        for (int wire = 0; wire < 2; ++wire)
            TAUTWIRE_UNROLL
            for (int i = 0; i < 6; ++i) {
                if (support >= 0) x[wire][i] *= line.supports[support].free[wire][i];
                const Doubles before = (kFirst ? start() : end()).a[row][wire][i];
                end().a[row][wire][i] = before + x[wire][i];
            }
        for (int n = 0; n < count; ++n) {
            if (!apart[n].rows.contains(row)) continue;
            const double here = size[apart[n].lane];
            inside = inside > here ? inside : here;
            size[apart[n].lane] = 0;
        }
        outside = maximum(outside, size);
    }
    double sum = 0.0;
    for (int lane = 0; lane < kLanesOf<V>; ++lane) sum += total[lane];
    const double largest = largest_lane(outside);
    return {std::isfinite(sum) ? (inside > largest ? inside : largest) : sum - sum, largest};
}

}  // namespace tautwire::TAUTWIRE_ISA
