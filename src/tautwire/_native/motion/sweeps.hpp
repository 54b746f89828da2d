// One iteration of a time step: residual and forward elimination in one sweep along the line,
// backward substitution and update of the accelerations in a second one.
//
// A state is kept as q_p, v_p and a with q = q_p + to_position a and v = v_p + to_velocity a. The
// first sweeps of a step read the state at its start and write the one at its end, so that a step
// can be dropped.
//
// The parts of the line are swept side by side; what one leaves for the next is exchanged in between.
#pragma once

#include "chain/preconditioner.hpp"
#include "line/attachments.hpp"
#include "line/forces.hpp"
#include "team.hpp"

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

class Sweeps {
public:
    Sweeps(const LineData& data, double weight)
        : line(data, weight), attached(data, line), known(line.layout.rows),
          sizes(line.layout.rows), states_{WireState(line.layout.rows), WireState(line.layout.rows)},
          damping_(line.layout.rows) {
        start().q_p.copy_from(line.position);
        known.copy_from(line.load);
        for (int row = 0; row < line.layout.rows; ++row) set_damping(row);
    }

    Line line;
    Attachments attached;
    Buffer<Row> known;      // forces known at the start of a step
    Prediction prediction;  // of the step in progress
    Buffer<Floats> sizes;   // per row: largest |increment| of each node in the last iteration
    Team* team = nullptr;   // does the parts

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

    // Eliminate the residual of the present iterate in a set of rows. With kFirst, in all rows, that
    // iterate is the prediction, which is made on the way, and the preconditioner is turned to it.
    template <bool kFirst, class P>
    void eliminate(P& preconditioner, const RowSet& set);

    // Correct what is eliminated for the couplings that act; false when that fails. See Couplings.
    template <class P>
    bool correct(P& preconditioner, const RowSet& set, const bool* closed, const double* compliance);

    // Substitute back and update the accelerations; return the largest change of one, or NaN when
    // the state is not finite.
    template <bool kFirst, class P>
    double substitute(P& preconditioner, const RowSet& set);

    // The nodes at the start of the step, and at its end: predicted, or of the present iterate.
    MotionView at_start() const {
        return {start().q_p, start().v_p, start().a, 0.0, start().to_position, start().to_velocity};
    }
    MotionView predicted() const {
        return {start().q_p, start().v_p, start().a, prediction.time_step,
                prediction.a_to_q + end().to_position, prediction.a_to_v + end().to_velocity};
    }
    MotionView at_end() const {
        return {end().q_p, end().v_p, end().a, 0.0, end().to_position, end().to_velocity};
    }

    // Nodal inertia forces M a at the end of the step.
    void inertia(Buffer<Row>& out) const;

private:
    void set_damping(int row);
    // Do work(part) for all parts; side by side if the set has rows in several, else the calling thread
    // does it, although the rows of the second part may lie in the other's cache.
    template <class F>
    void share(const RowSet& set, const F& work) {
        if (set.is_shared()) {
            team->share(line.layout.parts, work);
        } else {
            for (int part = 0; part < line.layout.parts; ++part) work(part);
        }
    }
    template <bool kFirst, bool kStore>
    TAUTWIRE_INLINE void move(int row, Motion& out);
    TAUTWIRE_INLINE void clear_held(int row, Row& r) const {
        const Row& free = line.holds[line.hold_of[row]].free;
        for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 6; ++i) r[half][i] *= free[half][i];
    }
    template <bool kSingle>
    TAUTWIRE_INLINE void wires(int row, const Motion& left, const Motion& right, Ends (&out)[2]) const;
    static void wrap(const Motion& first, const Motion& last, Motion& out);
    static void shift(Row& carry) {
        for (int i = 0; i < 6; ++i) {
            Doubles x[2] = {carry[0][i], carry[1][i]};
            to_next_piece(x);
            carry[0][i] = x[0];
            carry[1][i] = x[1];
        }
    }
    template <bool kFirst, bool kSingle>
    void enter(int row, Motion& here, Row& carry);
    template <bool kFirst>
    TAUTWIRE_INLINE void advance(int row, int bound, const Motion& here, Motion& next, Motion& behind);
    template <bool kFirst, class P>
    void eliminate(P& preconditioner, const RowSet& set, int part);
    // Largest lane by lane of |x|, and their sum, in which values that are not finite are found.
    struct Size {
        Floats largest, total;
    };
    template <bool kFirst, class P>
    void substitute(P& preconditioner, const RowSet& set, int part, Size& size);

    WireState states_[2];
    int now_ = 0;
    Buffer<Damping> damping_;
};

inline void Sweeps::set_damping(int row) {
    constexpr int kSlot[9] = {6, 7, 8, 3, 4, 5, 9, 10, 11};  // r2, r1', r2' of (r1, r1', r2, r2')
    Doubles k[2][12][12];
    for (int half = 0; half < 2; ++half) {
        const Element& element = line.element[2 * row + half];
        Doubles left[6], right[6], tangent[kPacked];
        element_nodes(line, line.position, row, half, left, right);
        elastic_tangent(
            parabola(left, right, element.inverse_length), element.stiffness, tangent);
        nodal_tangent(tangent, element, k[half]);
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
    for (int half = 0; half < 2; ++half)
        TAUTWIRE_UNROLL
        for (int i = 0; i < 6; ++i) {
            const Doubles acceleration = from.a[row][half][i];
            Doubles q = from.q_p[row][half][i], v = from.v_p[row][half][i];
            if constexpr (kFirst) {
                q += prediction.time_step * v + prediction.a_to_q * acceleration;
                v += prediction.a_to_v * acceleration;
                if constexpr (kStore) {
                    to.q_p[row][half][i] = q;
                    to.v_p[row][half][i] = v;
                }
            }
            v += to.to_velocity * acceleration;
            out.q[half][i] = q + to.to_position * acceleration;
            out.s[half][i] = acceleration + line.damping_mass * v;
            (i < 3 ? out.v[half][i] : slope_rate[half][i - 3]) = v;
        }
    TAUTWIRE_UNROLL
    for (int i = 0; i < 3; ++i) out.turn[i] = join(slope_rate[0][i], slope_rate[1][i]);
}

// Forces of the elements behind a row: minus elastic, damping and inertia forces.
template <bool kSingle>
TAUTWIRE_INLINE void Sweeps::wires(
    int row, const Motion& left, const Motion& right, Ends (&out)[2]) const {
    const Element* element = &line.element[2 * row];
    const Parabola<Doubles> e[2] = {parabola(left.q[0], right.q[0], element[0].inverse_length),
                                    parabola(left.q[1], right.q[1], element[1].inverse_length)};
    Parabola<Doubles> f[2];
    elastic_forces<kSingle>(element, e, f);
    for (int half = 0; half < 2; ++half)
        out[half] = wire_forces(element[half], f[half], left.s[half], right.s[half]);
    if (line.damping_stiffness == 0.0) return;
    Floats damping[9];
    damping_forces(damping_[row], left, right, damping);
    TAUTWIRE_UNROLL
    for (int half = 0; half < 2; ++half)
        TAUTWIRE_UNROLL
        for (int i = 0; i < 3; ++i) {
            const Doubles drag = widen(damping[i], half);
            out[half].left[i] += drag;
            out[half].right[i] -= drag;
            out[half].left[3 + i] -= widen(damping[3 + i], half);
            out[half].right[3 + i] -= widen(damping[6 + i], half);
        }
}

// The row behind the last one: the first of the next piece; behind the last piece, which has no next
// one, any regular node.
inline void Sweeps::wrap(const Motion& first, const Motion& last, Motion& out) {
    out = first;
    for (int i = 0; i < 6; ++i) {
        Doubles q[2] = {first.q[0][i], first.q[1][i]}, s[2] = {first.s[0][i], first.s[1][i]};
        to_previous_piece(q);
        to_previous_piece(s);
        q[1][kLanes - 1] = last.q[1][i][kLanes - 1] + (i == 0 ? 1.0 : 0.0);
        for (int half = 0; half < 2; ++half) {
            out.q[half][i] = q[half];
            out.s[half][i] = s[half];
        }
    }
    for (int i = 0; i < 3; ++i) {
        Doubles v[2] = {first.v[0][i], first.v[1][i]};
        to_previous_piece(v);
        out.v[0][i] = v[0];
        out.v[1][i] = v[1];
        out.turn[i] = to_previous_piece(first.turn[i]);
    }
}

// Begin to form residuals at a row: its motion, and what the elements before it do to it. Those of
// the last row act on the next piece.
template <bool kFirst, bool kSingle>
void Sweeps::enter(int row, Motion& here, Row& carry) {
    Motion before, behind;
    Ends ends[2];
    move<kFirst, false>(line.layout.before(row), before);
    move<kFirst, true>(row, here);
    if (row == 0) wrap(here, before, behind);
    wires<kSingle>(line.layout.before(row), before, row == 0 ? behind : here, ends);
    for (int k = 0; k < 12; ++k) carry[k / 6][k % 6] = ends[k / 6].right[k % 6];
    if (row == 0) shift(carry);
}

// Form the motion of the row after one of a part that ends at `bound`. In the last row of all it is
// that of the first row, and `behind` is the motion of the pieces' next nodes.
template <bool kFirst>
TAUTWIRE_INLINE void Sweeps::advance(
    int row, int bound, const Motion& here, Motion& next, Motion& behind) {
    if (row + 1 < bound) {
        move<kFirst, true>(row + 1, next);
    } else {
        move<kFirst, false>(line.layout.after(row), next);
        if (row + 1 == line.layout.rows) wrap(next, here, behind);
    }
}

template <bool kFirst, class P>
void Sweeps::eliminate(P& preconditioner, const RowSet& set, int part) {
    const int rows = line.layout.rows, bound = line.layout.bound(part + 1);
    Motion nodes[2], behind;
    Ends ends[2];
    Row carry;
    for (const Run& run : set.runs[part]) {
        bool entered = false;
        for (int row = run.first, side = 0; row <= run.last(); ++row) {
            if (!set.formed[row]) {
                preconditioner.pass(row, row == run.first);
                entered = false;
                continue;
            }
            if (!entered) enter<kFirst, P::kSingleBending>(row, nodes[side], carry);
            entered = true;
            const Motion& here = nodes[side];
            Motion& next = nodes[1 - side];
            advance<kFirst>(row, bound, here, next, behind);
            wires<P::kSingleBending>(row, here, row + 1 < rows ? next : behind, ends);
            Row r;
            TAUTWIRE_UNROLL
            for (int half = 0; half < 2; ++half)
                TAUTWIRE_UNROLL
                for (int i = 0; i < 6; ++i) {
                    r[half][i] = known[row][half][i] + (carry[half][i] + ends[half].left[i]);
                    if (i < 3) r[half][i] -= line.node_mass[2 * row + half] * here.s[half][i];
                    carry[half][i] = ends[half].right[i];
                }
            if (line.hold_of[row] >= 0) clear_held(row, r);
            if constexpr (kFirst) preconditioner.set_rotation(row, here.q);
            preconditioner.eliminate(row, row == run.first, r);
            side = 1 - side;
        }
        preconditioner.end_run(part, run);
    }
}

template <bool kFirst, class P>
void Sweeps::eliminate(P& preconditioner, const RowSet& set) {
    const MotionView view = kFirst ? predicted() : at_end();
    share(set, [&](int part) { attached.evaluate(view, set, part); });
    share(set, [&](int part) {
        if (set.runs[part].size() == 0) return;
        attached.push(known, set, part);
        eliminate<kFirst>(preconditioner, set, part);
        attached.release(known, set, part);
    });
}

template <class P>
bool Sweeps::correct(P& preconditioner, const RowSet& set, const bool* closed, const double* compliance) {
    const int parts = line.layout.parts;
    const bool is_local = preconditioner.is_local();
    for (int part = 0; !is_local && part < parts; ++part) preconditioner.finish_elimination(set, part);
    share(set, [&](int part) {
        if (is_local) preconditioner.finish_elimination(set, part);
        preconditioner.project(set, part);
    });
    if (!preconditioner.solve_couplings(closed, compliance)) return false;
    share(set, [&](int part) { preconditioner.apply_couplings(set, part); });
    return true;
}

inline void Sweeps::inertia(Buffer<Row>& out) const {
    const int rows = line.layout.rows;
    const Parabola<Doubles> none = {};
    for (int row = 0; row < rows; ++row)
        for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 6; ++i)
                out[row][half][i] = i < 3 ? line.node_mass[2 * row + half] * end().a[row][half][i]
                                          : broadcast<Doubles>(0.0);
    for (int row = 0; row < rows; ++row)
        for (int half = 0; half < 2; ++half) {
            Doubles left[6], right[6];
            element_nodes(line, end().a, row, half, left, right);
            const Ends ends = wire_forces(line.element[2 * row + half], none, left, right);
            const int behind = row + 1 < rows ? row + 1 : 0;
            for (int i = 0; i < 6; ++i) {
                out[row][half][i] -= ends.left[i];
                Doubles right[2] = {broadcast<Doubles>(0.0), broadcast<Doubles>(0.0)};
                right[half] = ends.right[i];
                if (!behind) to_next_piece(right);
                out[behind][0][i] -= right[0];
                out[behind][1][i] -= right[1];
            }
        }
}

template <bool kFirst, class P>
void Sweeps::substitute(P& preconditioner, const RowSet& set, int part, Size& size) {
    Floats largest = broadcast<Floats>(0.0), total = largest;
    for (int row = line.layout.bound(part); row < line.layout.bound(part + 1); ++row)
        if (!set.solved[row]) sizes[row] = total;
    for (const Run& run : set.runs[part]) {
        typename P::Local local;
        preconditioner.begin_substitution(set, run, local);
        for (int row = run.last(); row >= run.first; --row) {
            Row x;
            preconditioner.substitute(row, local, x, sizes[row], total);
            if (line.hold_of[row] >= 0) clear_held(row, x);
            TAUTWIRE_UNROLL
            for (int half = 0; half < 2; ++half)
                TAUTWIRE_UNROLL
                for (int i = 0; i < 6; ++i) {
                    const Doubles before = (kFirst ? start() : end()).a[row][half][i];
                    end().a[row][half][i] = before + x[half][i];
                }
            largest = maximum(largest, sizes[row]);
        }
    }
    size = {largest, total};
}

template <bool kFirst, class P>
double Sweeps::substitute(P& preconditioner, const RowSet& set) {
    const int parts = line.layout.parts;
    Size size[kMostParts];
    share(set, [&](int part) { substitute<kFirst>(preconditioner, set, part, size[part]); });
    for (int part = 1; part < parts; ++part) {
        size[0].largest = maximum(size[0].largest, size[part].largest);
        size[0].total += size[part].total;
    }
    double sum = 0.0;
    for (int piece = 0; piece < kPieces; ++piece) sum += size[0].total[piece];
    return std::isfinite(sum) ? largest_lane(size[0].largest) : sum - sum;
}

}  // namespace tautwire::TAUTWIRE_ISA
