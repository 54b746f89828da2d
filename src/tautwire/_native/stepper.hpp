// The time loop: co-rotated modified Newton to a tolerance, with a watchdog.
//
// The algorithm is that of numerics/reference_stepper.py.
#pragma once

#include <limits>

#include "contact.hpp"
#include "factors.hpp"
#include "pantograph.hpp"
#include "sweeps.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Watches the contraction of one step's iteration and says when a new factor is needed.
class Watchdog {
public:
    explicit Watchdog(bool full) : full_newton(full), wants_factor(full) {}

    void observe(double increment) {
        ++count;
        if (full_newton) return;
        const bool is_slow = increment > kSlow * last_;
        slow_ += is_slow;
        last_ = increment;
        wants_factor = is_slow && slow_ == kAllowed;
        if (slow_ > 2 * kAllowed) full_newton = wants_factor = true;
    }

    bool full_newton, wants_factor;
    int count = 0;

private:
    static constexpr double kSlow = 0.3;
    static constexpr int kAllowed = 2;
    double last_ = std::numeric_limits<double>::infinity();
    int slow_ = 0;
};

class LineEngine final : public Engine {
public:
    LineEngine(const LineData& data, const Scheme& scheme)
        : scheme_(scheme), weight_(1.0 + scheme.alpha), sweeps_(data, weight_),
          factors_(sweeps_.line, scheme), hanger_force_(sweeps_.line.hangers.size()) {}
    ~LineEngine() override {
        for (int i = 0; i < count_; ++i) delete pantographs_[i];
    }

    void add_pantograph(const PantographData& data) override {
        pantographs_.grow(count_ + 1);
        regions_.grow(count_ + 1);
        touches_.make_room(count_ + 1);
        pantographs_[count_++] = new Pantograph(data, scheme_);
        stages_ += data.stages;
    }
    Outcome advance(const Chunk& chunk, int& done) override;
    bool start_from(const double* q, const double* v) override;
    void coordinates(double* out) const override {
        gather(sweeps_.start().q_p, sweeps_.start().to_position, out);
    }
    void velocities(double* out) const override {
        gather(sweeps_.start().v_p, sweeps_.start().to_velocity, out);
    }
    std::size_t state_size() const override;
    void save(double* out) const override;
    void restore(const double* in) override;
    Counters counters() const override { return counters_; }
    Timings timings() const override { return timings_; }

private:
    Outcome step(const Chunk& chunk, int index);
    Outcome solve(const Chunk& chunk, Watchdog watch);
    void enter(const Chunk& chunk, int index);
    void rest();
    void step_back(const Buffer<Row>& sound);
    bool touch_all();
    Outcome finish(const Chunk& chunk);
    void set_regions();
    template <class S>
    Increment iterate(S& solver, RowRange range, bool fresh);
    bool settle_contacts();
    bool renew(bool full_newton);
    void carry_over();
    void record(const Chunk& chunk, int index);
    void record_droppers(double* out);
    void gather(const Buffer<Row>& base, double factor, double* out) const;
    void scatter(const double* in, Buffer<Row>& out) const;

    // The wires at the present iterate.
    WireView wires() const {
        const Prediction& p = sweeps_.prediction;
        if (!first_) return {sweeps_.line, sweeps_.end()};
        return {sweeps_.line, sweeps_.start(), p.time_step, p.a_to_q + sweeps_.end().to_position};
    }

    Scheme scheme_;
    double weight_;
    Sweeps sweeps_;
    StepFactors factors_;
    Buffer<Pantograph*> pantographs_;
    int count_ = 0, stages_ = 0;
    TouchList touches_;
    Buffer<Region> regions_;  // around the touched points
    bool first_ = false;  // the next sweeps are the first of their step
    Counters counters_ = {};
    Timings timings_ = {};
    Buffer<Doubles> hanger_force_;
};

inline Outcome LineEngine::advance(const Chunk& chunk, int& done) {
    sweeps_.set_time_step(chunk.time_step);
    for (int i = 0; i < count_; ++i) pantographs_[i]->set_time_step(chunk.time_step);
    Outcome outcome = Outcome::running;
    const double begin = seconds();
    for (done = 0; done < chunk.steps; ++done) {
        outcome = step(chunk, done);
        if (outcome != Outcome::running) break;
        const double before = seconds();
        record(chunk, done);
        timings_.records += seconds() - before;
    }
    timings_.total += seconds() - begin;
    return outcome;
}

inline Outcome LineEngine::step(const Chunk& chunk, int index) {
    enter(chunk, index);
    sweeps_.begin(scheme_, chunk.time_step);
    if (scheme_.full_newton) sweeps_.predict();
    Outcome outcome = solve(chunk, Watchdog(scheme_.full_newton));
    if (outcome != Outcome::running) {
        // Long steps make the prediction, with its accelerations kept, so poor that wires are pushed
        // and the tangent is indefinite; where the wires are, it is not.
        sweeps_.predict();
        rest();
        outcome = solve(chunk, Watchdog(true));
    }
    return outcome == Outcome::running ? finish(chunk) : outcome;
}

// Find the end of the step: from the prediction, or with full Newton from end().
inline Outcome LineEngine::solve(const Chunk& chunk, Watchdog watch) {
    first_ = !watch.full_newton;
    if (first_ && !factors_.select(chunk.time_step)) return Outcome::singular;
    const RowRange whole = sweeps_.line.layout.whole();
    Buffer<Row> sound;  // the last accelerations at which the tangent was positive definite
    for (int n = 0; n < scheme_.iterations; ++n) {
        if (!touch_all()) return Outcome::off_the_line;
        const bool fresh = n == 0 || watch.wants_factor;
        if (watch.wants_factor && !renew(watch.full_newton)) {
            if (sound.size() == 0) return Outcome::singular;
            step_back(sound);
            continue;
        }
        if (watch.full_newton) {
            if (sound.size() == 0) sound = Buffer<Row>(sweeps_.line.layout.rows);
            sound.copy_from(sweeps_.end().a);
        }
        const Increment increment = watch.full_newton ? iterate(factors_.coupled(), whole, fresh)
                                                      : iterate(factors_.apart(), whole, fresh);
        ++counters_.iterations;
        if (std::isnan(increment.all)) return Outcome::not_finite;
        if (watch.count > 0 && (increment.all <= scheme_.tolerance ||
                                (increment.outside <= scheme_.tolerance && !watch.full_newton &&
                                 settle_contacts()))) {
            counters_.full_newton_steps += watch.full_newton;
            return Outcome::running;
        }
        watch.observe(increment.all);
    }
    return Outcome::not_converged;
}

// Take the wires at the end of the step to be where they are at its start.
inline void LineEngine::rest() {
    const WireState &now = sweeps_.start(), &end = sweeps_.end();
    for (int row = 0; row < sweeps_.line.layout.rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i)
                sweeps_.end().a[row][wire][i] =
                    (now.q_p[row][wire][i] + now.to_position * now.a[row][wire][i] -
                     end.q_p[row][wire][i]) /
                    broadcast<Doubles>(end.to_position);
}

// Take back half of what led from the accelerations `sound` to the present ones.
inline void LineEngine::step_back(const Buffer<Row>& sound) {
    for (int row = 0; row < sweeps_.line.layout.rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                Doubles& a = sweeps_.end().a[row][wire][i];
                a = 0.5 * (a + sound[row][wire][i]);
            }
}

// Advance the pantographs that are on the line without contact force.
inline void LineEngine::enter(const Chunk& chunk, int index) {
    touches_.count = 0;
    std::ptrdiff_t stage = static_cast<std::ptrdiff_t>(index) * stages_;
    for (int i = 0; i < count_; stage += pantographs_[i++]->stages()) {
        const int at = index * count_ + i;
        if (!chunk.on_line[at]) continue;
        pantographs_[i]->predict(chunk.before + stage, chunk.after + stage);
        touches_.add(i, chunk.position[at], chunk.rise[at]);
    }
}

inline bool LineEngine::touch_all() {
    const WireView view = wires();
    for (int n = 0; n < touches_.count; ++n) {
        Touch& touch = touches_[n];
        const Pantograph& pantograph = *pantographs_[touch.pantograph];
        if (!view.locate(touch, pantograph.element)) return false;
        const double approach = pantograph.head_free - touch.surface();
        touch.stiffness = pantograph.stiffness_in_series;
        // A height that is not a number must stay one, so no maximum here.
        touch.force = approach <= 0.0 ? 0.0 : touch.stiffness * approach;
    }
    return true;
}

// Enclose the touched points: there, where the wire bends most, the iteration converges slowest.
inline void LineEngine::set_regions() {
    constexpr int kReach = 12;
    const Layout& layout = sweeps_.line.layout;
    for (int n = 0; n < touches_.count; ++n) {
        const int row = layout.row(touches_[n].element), last = row + 1 + kReach;
        regions_[n] = {{row < kReach ? 0 : row - kReach, last < layout.rows ? last : layout.rows - 1},
                       layout.lane(touches_[n].element)};
    }
}

// Iterate once in a range of rows; return the largest increments of a coordinate.
template <class S>
Increment LineEngine::iterate(S& solver, RowRange range, bool fresh) {
    const double begin = seconds();
    const bool first = first_;
    first_ = false;
    touches_.push(sweeps_, weight_);
    if (first) {
        sweeps_.eliminate<true>(solver.matrix, range);
    } else {
        sweeps_.eliminate<false>(solver.matrix, range);
    }
    touches_.release(sweeps_);
    const double eliminated = seconds();
    if (fresh) solver.contacts.set(solver.matrix, touches_);
    solver.contacts.correct(solver.matrix, touches_, weight_ * sweeps_.end().to_position);
    set_regions();
    const double corrected = seconds();
    const Increment increment =
        first ? sweeps_.substitute<true>(solver.matrix, range, regions_.data(), touches_.count)
              : sweeps_.substitute<false>(solver.matrix, range, regions_.data(), touches_.count);
    timings_.elimination += eliminated - begin;
    timings_.contacts += corrected - eliminated;
    timings_.substitution += seconds() - corrected;
    const double scale = sweeps_.end().to_position;
    return {scale * increment.all, scale * increment.outside};
}

// Iterate around the contacts alone, when the rest has converged; true when they have, too.
inline bool LineEngine::settle_contacts() {
    constexpr int kMost = 3;
    for (int n = 0; n < kMost; ++n) {
        double largest = 0.0;
        for (int k = 0; k < touches_.count; ++k) {
            ++counters_.local_iterations;
            if (!touch_all()) return false;
            const Increment increment = iterate(factors_.apart(), regions_[k].rows, false);
            if (!(increment.all <= largest)) largest = increment.all;
        }
        if (largest <= scheme_.tolerance) return true;
    }
    return false;
}

// Factor the matrix at the present iterate.
inline bool LineEngine::renew(bool full_newton) {
    const WireState& end = sweeps_.end();
    const int rows = sweeps_.line.layout.rows;
    Buffer<Row> q(rows), v(rows);
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                q[row][wire][i] = end.q_p[row][wire][i] + end.to_position * end.a[row][wire][i];
                v[row][wire][i] = end.v_p[row][wire][i] + end.to_velocity * end.a[row][wire][i];
            }
    ++counters_.refactorisations;
    return full_newton ? factors_.factor_coupled(q, v, sweeps_.prediction.time_step)
                       : factors_.renew(q);
}

// Complete a converged step, unless a contact opens or closes in it and that is not wanted.
inline Outcome LineEngine::finish(const Chunk& chunk) {
    if (!touch_all()) return Outcome::off_the_line;
    Buffer<double> gap(count_);
    bool crosses = false;
    for (int i = 0; i < count_; ++i) gap[i] = pantographs_[i]->gap;
    for (int n = 0; n < touches_.count; ++n) {
        const int i = touches_[n].pantograph;
        gap[i] = touches_[n].surface() - pantographs_[i]->finish(touches_[n].force);
        const double before = pantographs_[i]->gap;
        crosses |= !std::isnan(before) && (before < 0.0) != (gap[i] < 0.0);
    }
    if (crosses && chunk.until_crossing) {
        for (int i = 0; i < count_; ++i) chunk.refused_gap[i] = gap[i];
        return Outcome::crossing;
    }
    for (int n = 0; n < touches_.count; ++n) {
        Pantograph& pantograph = *pantographs_[touches_[n].pantograph];
        pantograph.accept();
        pantograph.force = touches_[n].force;
        pantograph.gap = gap[touches_[n].pantograph];
        pantograph.wire_height = touches_[n].height;
        pantograph.element = touches_[n].element;
    }
    if (scheme_.alpha != 0.0) carry_over();
    sweeps_.accept();
    ++counters_.steps;
    return Outcome::running;
}

// HHT: known = (1 + alpha) load + alpha g with g = (alpha g_n - M a)/(1 + alpha).
inline void LineEngine::carry_over() {
    const double factor = scheme_.alpha / weight_;
    Buffer<Row> inertia(sweeps_.line.layout.rows);
    sweeps_.inertia(inertia);
    for (int row = 0; row < sweeps_.line.layout.rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                const Doubles load = sweeps_.line.load[row][wire][i];
                Doubles& known = sweeps_.known[row][wire][i];
                known = load + factor * (known - load - inertia[row][wire][i]);
            }
}

inline bool LineEngine::start_from(const double* q, const double* v) {
    constexpr int kRefinements = 3;
    WireState &now = sweeps_.start(), &end = sweeps_.end();
    const RowRange whole = sweeps_.line.layout.whole();
    scatter(q, end.q_p);
    scatter(v, end.v_p);
    end.a = Buffer<Row>(sweeps_.line.layout.rows);
    end.to_velocity = end.to_position = 0.0;  // forces at q and v, whatever a is
    sweeps_.known.copy_from(sweeps_.line.load);
    if (!factors_.factor_mass(end.q_p)) return false;
    for (int n = 0; n < kRefinements; ++n) {  // find (1 + alpha) a from M a = -g
        sweeps_.eliminate<false>(factors_.coupled().matrix, whole);
        sweeps_.substitute<false>(factors_.coupled().matrix, whole, nullptr, 0);
    }
    if (scheme_.alpha != 0.0) carry_over();
    for (std::size_t row = 0; row < end.a.size(); ++row)
        for (int i = 0; i < 12; ++i) end.a[row][i / 6][i % 6] *= broadcast<Doubles>(1.0 / weight_);
    now.to_velocity = now.to_position = 0.0;
    sweeps_.accept();
    return true;
}

inline void LineEngine::record(const Chunk& chunk, int index) {
    const std::ptrdiff_t row = index;
    double* stage = chunk.stages + row * stages_;
    for (int i = 0; i < count_; ++i) {
        const Pantograph& pantograph = *pantographs_[i];
        chunk.force[row * count_ + i] = pantograph.force;
        chunk.gap[row * count_ + i] = pantograph.gap;
        chunk.height[row * count_ + i] = pantograph.wire_height;
        for (int j = 0; j < pantograph.stages(); ++j) *stage++ = pantograph.displacement()[j];
    }
    record_droppers(chunk.dropper_force + row * sweeps_.line.dropper_count);
    const WireView view(sweeps_.line, sweeps_.start());
    double* out = chunk.coordinates + row * chunk.observed;
    for (int i = 0; i < chunk.observed; ++i) {
        const int dof = static_cast<int>(chunk.observed_dofs[i]);
        *out++ = view.at(dof / 12, dof % 12 / 6, dof % 6);
    }
}

inline void LineEngine::record_droppers(double* out) {
    const Line& line = sweeps_.line;
    const WireState& s = sweeps_.start();
    for (int row = 0; row < line.layout.rows; ++row) {
        if (line.hanger_of[row] < 0) continue;
        Doubles t[3], rate[3];
        for (int i = 0; i < 3; ++i) {
            const Doubles a = s.a[row][1][i] - s.a[row][0][i];
            t[i] = s.q_p[row][1][i] - s.q_p[row][0][i] + s.to_position * a;
            rate[i] = s.v_p[row][1][i] - s.v_p[row][0][i] + s.to_velocity * a;
        }
        const Doubles length = square_root(dot(t, t));
        hanger_force_[line.hanger_of[row]] =
            dropper_force(line.hangers[line.hanger_of[row]], length, dot(t, rate) / length);
    }
    for (int i = 0; i < line.dropper_count; ++i)
        out[i] = hanger_force_[line.hanger_of[line.dropper_row[i]]][line.dropper_lane[i]] / weight_;
}

inline std::size_t LineEngine::state_size() const {
    std::size_t size = 3 + 4 * sizeof(Row) / sizeof(double) * sweeps_.line.layout.rows;
    for (int i = 0; i < count_; ++i) size += pantographs_[i]->state_size();
    return size;
}

inline void LineEngine::save(double* out) const {
    const WireState& s = sweeps_.start();
    for (const Buffer<Row>* part : {&s.q_p, &s.v_p, &s.a, &sweeps_.known}) {
        std::memcpy(out, part->data(), part->size() * sizeof(Row));
        out += part->size() * sizeof(Row) / sizeof(double);
    }
    *out++ = s.to_velocity;
    *out++ = s.to_position;
    *out++ = sweeps_.line.time_step();
    for (int i = 0; i < count_; ++i) out = pantographs_[i]->save(out);
}

inline void LineEngine::restore(const double* in) {
    WireState& s = sweeps_.start();
    for (Buffer<Row>* part : {&s.q_p, &s.v_p, &s.a, &sweeps_.known}) {
        std::memcpy(part->data(), in, part->size() * sizeof(Row));
        in += part->size() * sizeof(Row) / sizeof(double);
    }
    s.to_velocity = *in++;
    s.to_position = *in++;
    sweeps_.line.set_time_step(*in++);  // the loads that the known forces contain
    for (int i = 0; i < count_; ++i) in = pantographs_[i]->restore(in);
}

inline void LineEngine::gather(const Buffer<Row>& base, double factor, double* out) const {
    const Layout& layout = sweeps_.line.layout;
    for (int dof = 0; dof < 12 * layout.stations; ++dof) {
        const int row = layout.row(dof / 12), lane = layout.lane(dof / 12);
        const int wire = dof % 12 / 6, i = dof % 6;
        out[dof] = base[row][wire][i][lane] + factor * sweeps_.start().a[row][wire][i][lane];
    }
}

// Padding behind the line keeps its static coordinates.
inline void LineEngine::scatter(const double* in, Buffer<Row>& out) const {
    const Layout& layout = sweeps_.line.layout;
    out.copy_from(sweeps_.line.position);
    for (int dof = 0; dof < 12 * layout.stations; ++dof)
        out[layout.row(dof / 12)][dof % 12 / 6][dof % 6][layout.lane(dof / 12)] = in[dof];
}

}  // namespace tautwire::TAUTWIRE_ISA
