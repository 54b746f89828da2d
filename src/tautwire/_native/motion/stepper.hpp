// The time loop: co-rotated modified Newton to a tolerance, with a watchdog.
//
// The algorithm is that of numerics/motion/reference_stepper.py.
#pragma once

#include <limits>

#include "contact/touches.hpp"
#include "motion/factors.hpp"
#include "motion/selection.hpp"
#include "motion/sweeps.hpp"

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
    // As in numerics/motion/step_solver.py, which says why. Here 0.2 and 0.5 take 5.5 and
    // 6.3 in place of 5.8 iterations per step of AC simple at 3 ms, and about as long.
    static constexpr double kSlow = 0.3;
    static constexpr int kAllowed = 2;
    double last_ = std::numeric_limits<double>::infinity();
    int slow_ = 0;
};

class LineEngine final : public Engine {
public:
    LineEngine(const LineData& data, const Scheme& scheme)
        : scheme_(scheme), weight_(1.0 + scheme.alpha), sweeps_(data, weight_),
          team_(sweeps_.line.layout.parts > 1 ? scheme.threads : 1, scheme.awaits_helpers),
          factors_(sweeps_.line, sweeps_.attached, data, scheme), whole_(sweeps_.line.layout),
          selection_(sweeps_.line.layout), paths_(data.paths) {
        sweeps_.team = &team_;
        for (int i = 0; i < data.paths; ++i)
            paths_[i] = {static_cast<int>(data.path_nodes[2 * i]),
                         static_cast<int>(data.path_nodes[2 * i + 1]), data.path_stiffness[i]};
    }
    ~LineEngine() override {
        for (Pantograph* pantograph : pantographs_) delete pantograph;
    }

    void add_pantograph(const PantographData& data) override {
        pantographs_.push(new Pantograph(data, scheme_));
        stages_ += data.stages;
        for (const Path& path : paths_) pairs_.push({0.0, NAN, NAN, path.first});
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
    Counters counters() const override {
        Counters told = counters_;
        told.helped_parts = team_.helped_parts();
        return told;
    }
    int threads() const override { return team_.threads(); }
    Timings timings() const override { return timings_; }

private:
    // A pantograph and a path at the last accepted instant.
    struct Pair {
        double force, gap, height;
        int element;
    };

    Outcome step(const Chunk& chunk, int index);
    Outcome solve(Watchdog watch);
    void rest();
    void step_back(const Buffer<Row>& sound);
    bool enter(const Chunk& chunk, int index);
    bool touch_all();
    Outcome finish(const Chunk& chunk);
    template <class P>
    double iterate(P& matrix, const RowSet& rows, bool fresh);
    bool settle(int iteration);
    void review(bool learns, bool everywhere);
    // The tolerance as an acceleration.
    float bound() { return static_cast<float>(scheme_.tolerance / sweeps_.end().to_position); }
    bool renew(bool full_newton);
    void carry_over();
    void record(const Chunk& chunk, int index);
    void gather(const Buffer<Row>& base, double factor, double* out) const;
    void scatter(const double* in, Buffer<Row>& out) const;

    int count() const { return static_cast<int>(pantographs_.size()); }
    Pair& pair(const Touch& touch) {
        return pairs_[touch.pantograph * paths_.size() + touch.path];
    }
    // The wires at the present iterate.
    WireView wires() const {
        return {sweeps_.line, first_ ? sweeps_.predicted() : sweeps_.at_end()};
    }

    Scheme scheme_;
    double weight_;
    Sweeps sweeps_;
    Team team_;
    StepFactors factors_;
    RowSet whole_;
    Selection selection_;
    List<int> touched_;
    Buffer<Path> paths_;
    List<Pantograph*> pantographs_;
    List<Pair> pairs_;  // [pantograph][path]
    int stages_ = 0;
    TouchList touches_;
    Buffer<double> gaps_;   // at the end of the step, of every pair
    bool first_ = false;    // the next sweeps are the first of their step
    Counters counters_ = {};
    Timings timings_ = {};
};

inline Outcome LineEngine::advance(const Chunk& chunk, int& done) {
    sweeps_.set_time_step(chunk.time_step);
    for (Pantograph* pantograph : pantographs_) pantograph->set_time_step(chunk.time_step);
    Outcome outcome = Outcome::running;
    const double begin = seconds();
    team_.begin();
    for (done = 0; done < chunk.steps; ++done) {
        outcome = step(chunk, done);
        if (outcome != Outcome::running) break;
        const double before = seconds();
        record(chunk, done);
        timings_.records += seconds() - before;
    }
    team_.end(done);
    timings_.total += seconds() - begin;
    return outcome;
}

inline Outcome LineEngine::step(const Chunk& chunk, int index) {
    sweeps_.begin(scheme_, chunk.time_step);
    first_ = !scheme_.full_newton;
    if (scheme_.full_newton) sweeps_.predict();
    if (!enter(chunk, index)) return Outcome::off_the_line;
    Outcome outcome = solve(Watchdog(scheme_.full_newton));
    if (outcome != Outcome::running) {
        // Long steps make the prediction, with its accelerations kept, so poor that wires are pushed
        // and the tangent is indefinite; where the wires are, it is not.
        sweeps_.predict();
        rest();
        outcome = solve(Watchdog(true));
    }
    return outcome == Outcome::running ? finish(chunk) : outcome;
}

// Find the end of the step: from the prediction, or with full Newton from end().
inline Outcome LineEngine::solve(Watchdog watch) {
    first_ = !watch.full_newton;
    if (first_ && !factors_.select(sweeps_.prediction.time_step)) return Outcome::singular;
    if (first_) selection_.begin(sweeps_.prediction.time_step);
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
            sound.grow(sweeps_.end().a.size());
            sound.copy_from(sweeps_.end().a);
        }
        const double increment = watch.full_newton ? iterate(factors_.exact(), whole_, fresh)
                                                   : iterate(factors_.fast(), whole_, fresh);
        ++counters_.iterations;
        if (std::isnan(increment)) return Outcome::not_finite;
        if (!watch.full_newton) review(n > 0, true);
        if (watch.count > 0 && increment <= scheme_.tolerance) {
            counters_.full_newton_steps += watch.full_newton;
            return Outcome::running;
        }
        if (!watch.full_newton && settle(n)) return Outcome::running;
        watch.observe(increment);
    }
    return Outcome::not_converged;
}

// Take the wires at the end of the step to be where they are at its start.
inline void LineEngine::rest() {
    const WireState& now = sweeps_.start();
    WireState& end = sweeps_.end();
    const Doubles inverse = broadcast<Doubles>(1.0 / end.to_position);
    for (std::size_t row = 0; row < end.a.size(); ++row)
        for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 6; ++i)
                end.a[row][half][i] =
                    inverse * (now.q_p[row][half][i] + now.to_position * now.a[row][half][i] -
                               end.q_p[row][half][i]);
}

// Take back half of what led from the accelerations `sound` to the present ones.
inline void LineEngine::step_back(const Buffer<Row>& sound) {
    for (std::size_t row = 0; row < sound.size(); ++row)
        for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 6; ++i) {
                Doubles& a = sweeps_.end().a[row][half][i];
                a = 0.5 * (a + sound[row][half][i]);
            }
}

// Advance the pantographs that are on the line without contact force, and pair them with the paths
// they have; false when one has none.
inline bool LineEngine::enter(const Chunk& chunk, int index) {
    const WireView view = wires();
    touches_.clear();
    std::ptrdiff_t stage = static_cast<std::ptrdiff_t>(index) * stages_;
    for (int i = 0; i < count(); stage += pantographs_[i++]->stages()) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(index) * count() + i;
        if (!chunk.on_line[at]) continue;
        pantographs_[i]->predict(chunk.before + stage, chunk.after + stage);
        const int before = touches_.count();
        for (std::size_t path = 0; path < paths_.size(); ++path) {
            Touch touch = {i, static_cast<int>(path), ContactPlane::of(chunk.frame + 9 * at),
                           chunk.rise[at * paths_.size() + path], {}, true, paths_[path].stiffness, 0.0};
            if (view.locate(paths_[path], touch.plane, pair(touch).element, touch.point))
                touches_.add(touch);
        }
        if (touches_.count() == before) return false;
    }
    return true;
}

// Set the contact forces of the present iterate; false when a wire has moved away from its plane.
inline bool LineEngine::touch_all() {
    const WireView view = wires();
    for (int n = 0; n < touches_.count(); ++n) {
        Touch& touch = touches_[n];
        if (!view.locate(paths_[touch.path], touch.plane, touch.point.element, touch.point))
            return false;
        touch.meets = pantographs_[touch.pantograph]->reaches(touch.point.lateral);
    }
    for (int first = 0, last = 0; first < touches_.count(); first = last) {
        const int i = touches_[first].pantograph;
        while (last < touches_.count() && touches_[last].pantograph == i) ++last;
        touches_.press(first, last, pantographs_[i]->head_free, pantographs_[i]->compliance());
    }
    return true;
}

// Iterate once in a set of rows; return the largest increment of a coordinate.
template <class P>
double LineEngine::iterate(P& matrix, const RowSet& rows, bool fresh) {
    const double begin = seconds(), scale = sweeps_.end().to_position;
    const Layout& layout = sweeps_.line.layout;
    const bool first = first_;
    first_ = false;
    touches_.push(layout, sweeps_.known, weight_);
    if (first) {
        sweeps_.eliminate<true>(matrix, rows);
    } else {
        sweeps_.eliminate<false>(matrix, rows);
    }
    touches_.release(layout, sweeps_.known);
    const double eliminated = seconds();
    if (fresh) touches_.set_columns(matrix, weight_ * scale, pantographs_.begin());
    touches_.close(weight_ * scale * matrix.scale, pantographs_.begin());
    if (!sweeps_.correct(matrix, rows, touches_.closed(), touches_.compliance())) return NAN;
    const double corrected = seconds();
    const double increment = first ? sweeps_.substitute<true>(matrix, rows)
                                   : sweeps_.substitute<false>(matrix, rows);
    timings_.elimination += eliminated - begin;
    timings_.contacts += corrected - eliminated;
    timings_.substitution += seconds() - corrected;
    return scale * increment;
}

// After an iteration everywhere, the number of which is given, iterate on where that matters; true
// when the step has converged.
inline bool LineEngine::settle(int iteration) {
    // Steps take one or two; after three the whole line is iterated again.
    constexpr int kMost = 3;
    const Layout& layout = sweeps_.line.layout;
    for (int n = 0; n < kMost; ++n) {
        touched_.shorten(0);
        for (const Touch& touch : touches_) touched_.push(layout.slot(touch.point.element).row);
        const bool first = iteration == 0 && n == 0;
        if (!selection_.choose(bound(), touched_, first)) return true;
        if (first && (selection_.is_large() || selection_.verifies())) return false;
        if (!touch_all() || std::isnan(iterate(factors_.fast(), selection_.rows, false))) return false;
        ++counters_.local_iterations;
        counters_.local_rows += selection_.rows.formed_rows();
        counters_.solved_rows += selection_.rows.solved_rows();
        review(true, false);
    }
    return !selection_.choose(bound(), touched_, false);
}

// Let the selection look at the increments of an iteration in some rows or everywhere, after it has
// learned from them; what it had overlooked is counted.
inline void LineEngine::review(bool learns, bool everywhere) {
    const float limit = bound();
    team_.share(sweeps_.line.layout.parts, [&](int part) {
        if (learns) selection_.learn(sweeps_.sizes, limit, everywhere, part);
        selection_.look(sweeps_.sizes, limit, part);
    });
    if (!learns) return;
    if (everywhere) selection_.note_whole();
    const double overlooked = sweeps_.end().to_position * selection_.overlooked();
    if (overlooked > counters_.overlooked) counters_.overlooked = overlooked;
}

// Factor the matrix at the present iterate.
inline bool LineEngine::renew(bool full_newton) {
    const WireState& end = sweeps_.end();
    Buffer<Row> q(end.q_p.size()), v(q.size());
    for (std::size_t row = 0; row < q.size(); ++row)
        for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 6; ++i) {
                q[row][half][i] = end.q_p[row][half][i] + end.to_position * end.a[row][half][i];
                v[row][half][i] = end.v_p[row][half][i] + end.to_velocity * end.a[row][half][i];
            }
    ++counters_.refactorisations;
    return full_newton ? factors_.factor_exact(q, v, sweeps_.prediction.time_step) : factors_.renew(q);
}

// Complete a converged step, unless a pantograph leaves or meets the wires in it and that is not
// wanted.
inline Outcome LineEngine::finish(const Chunk& chunk) {
    if (!touch_all()) return Outcome::off_the_line;
    if (gaps_.size() < pairs_.size()) gaps_ = Buffer<double>(pairs_.size());
    bool crosses = false;
    for (int i = 0; i < count(); ++i) chunk.refused_gap[i] = pantographs_[i]->gap;
    for (int first = 0, last = 0; first < touches_.count(); first = last) {
        const int i = touches_[first].pantograph;
        double total = 0.0, least = NAN;
        for (; last < touches_.count() && touches_[last].pantograph == i; ++last)
            total += touches_[last].force;
        const double head = pantographs_[i]->finish(total), before = pantographs_[i]->gap;
        for (int n = first; n < last; ++n) {
            gaps_[n] = touches_[n].meets ? touches_[n].surface() - head : NAN;
            if (!(least <= gaps_[n]) && !std::isnan(gaps_[n])) least = gaps_[n];
        }
        if (std::isnan(least)) return Outcome::off_the_line;  // no wire is within reach of the head
        chunk.refused_gap[i] = least;
        crosses |= !std::isnan(before) && (before < 0.0) != (least < 0.0);
    }
    if (crosses && chunk.until_crossing) return Outcome::crossing;
    for (Pair& pair : pairs_) pair = {0.0, NAN, NAN, pair.element};
    for (int n = 0; n < touches_.count(); ++n) {
        const Touch& touch = touches_[n];
        Pantograph& pantograph = *pantographs_[touch.pantograph];
        if (n == 0 || touches_[n - 1].pantograph != touch.pantograph) {
            pantograph.accept();
            pantograph.force = 0.0;
            pantograph.gap = chunk.refused_gap[touch.pantograph];
        }
        pantograph.force += touch.force;
        pair(touch) = {touch.force, gaps_[n], touch.point.height, touch.point.element};
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
    for (std::size_t row = 0; row < inertia.size(); ++row)
        for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 6; ++i) {
                const Doubles load = sweeps_.line.load[row][half][i];
                Doubles& known = sweeps_.known[row][half][i];
                known = load + factor * (known - load - inertia[row][half][i]);
            }
}

inline bool LineEngine::start_from(const double* q, const double* v) {
    // The mass matrix is factored exactly but for HHT's share of the forces. Six passes change no
    // digit of the forces.
    constexpr int kRefinements = 3;
    WireState &now = sweeps_.start(), &end = sweeps_.end();
    scatter(q, end.q_p);
    scatter(v, end.v_p);
    end.a = Buffer<Row>(sweeps_.line.layout.rows);
    end.to_velocity = end.to_position = 0.0;  // forces at q and v, whatever a is
    sweeps_.known.copy_from(sweeps_.line.load);
    if (!factors_.factor_mass(end.q_p)) return false;
    ExactSolver& matrix = factors_.exact();
    matrix.clear_contacts();
    for (int n = 0; n < kRefinements; ++n) {  // find (1 + alpha) a from M a = -g
        sweeps_.eliminate<false>(matrix, whole_);
        sweeps_.correct(matrix, whole_, nullptr, nullptr);
        sweeps_.substitute<false>(matrix, whole_);
    }
    if (scheme_.alpha != 0.0) carry_over();
    for (Row& a : end.a)
        for (int i = 0; i < 12; ++i) a[i / 6][i % 6] *= broadcast<Doubles>(1.0 / weight_);
    now.to_velocity = now.to_position = 0.0;
    sweeps_.accept();
    return true;
}

inline void LineEngine::record(const Chunk& chunk, int index) {
    const std::ptrdiff_t row = index, width = static_cast<std::ptrdiff_t>(pairs_.size());
    for (std::ptrdiff_t n = 0; n < width; ++n) {
        chunk.force[row * width + n] = pairs_[n].force;
        chunk.gap[row * width + n] = pairs_[n].gap;
        chunk.height[row * width + n] = pairs_[n].height;
    }
    double* stage = chunk.stages + row * stages_;
    for (const Pantograph* pantograph : pantographs_)
        for (int j = 0; j < pantograph->stages(); ++j) *stage++ = pantograph->displacement()[j];
    const Attachments& attached = sweeps_.attached;
    const MotionView motion = sweeps_.at_start();
    double* ties = chunk.tie_force + row * static_cast<std::ptrdiff_t>(attached.ties.size());
    team_.share(sweeps_.line.layout.parts, [&](int part) { attached.tie_forces(motion, ties, part); });
    const WireView view(sweeps_.line, motion);
    double* out = chunk.coordinates + row * chunk.observed;
    for (int i = 0; i < chunk.observed; ++i) {
        const int dof = static_cast<int>(chunk.observed_dofs[i]);
        *out++ = view.at(dof / 6, dof % 6);
    }
}

inline std::size_t LineEngine::state_size() const {
    std::size_t size = 3 + 4 * sizeof(Row) / sizeof(double) * sweeps_.line.layout.rows + 4 * pairs_.size();
    for (const Pantograph* pantograph : pantographs_) size += pantograph->state_size();
    return size + selection_.state_size();
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
    out = selection_.save(out);
    for (const Pantograph* pantograph : pantographs_) out = pantograph->save(out);
    for (const Pair& pair : pairs_)
        for (const double value : {pair.force, pair.gap, pair.height, double(pair.element)}) *out++ = value;
}

inline void LineEngine::restore(const double* in) {
    WireState& s = sweeps_.start();
    for (Buffer<Row>* part : {&s.q_p, &s.v_p, &s.a, &sweeps_.known}) {
        std::memcpy(static_cast<void*>(part->data()), in, part->size() * sizeof(Row));
        in += part->size() * sizeof(Row) / sizeof(double);
    }
    s.to_velocity = *in++;
    s.to_position = *in++;
    sweeps_.line.set_time_step(*in++);  // the loads that the known forces contain
    in = selection_.restore(in);
    for (Pantograph* pantograph : pantographs_) in = pantograph->restore(in);
    for (Pair& pair : pairs_) {
        pair = {in[0], in[1], in[2], static_cast<int>(in[3])};
        in += 4;
    }
}

inline void LineEngine::gather(const Buffer<Row>& base, double factor, double* out) const {
    const Layout& layout = sweeps_.line.layout;
    const Buffer<Row>& a = sweeps_.start().a;
    for (int dof = 0; dof < 6 * layout.nodes; ++dof)
        out[dof] = value(base, layout, dof / 6, dof % 6) + factor * value(a, layout, dof / 6, dof % 6);
}

// Padding behind the wires keeps its static coordinates.
inline void LineEngine::scatter(const double* in, Buffer<Row>& out) const {
    const Layout& layout = sweeps_.line.layout;
    out.copy_from(sweeps_.line.position);
    for (int dof = 0; dof < 6 * layout.nodes; ++dof) value(out, layout, dof / 6, dof % 6) = in[dof];
}

}  // namespace tautwire::TAUTWIRE_ISA
