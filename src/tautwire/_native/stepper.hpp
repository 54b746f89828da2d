// The time loop: co-rotated modified Newton to a tolerance, with a watchdog.
//
// The algorithm is that of numerics/reference_stepper.py.
#pragma once

#include "contact.hpp"
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
    double last_ = HUGE_VAL;
    int slow_ = 0;
};

// A preconditioner and what belongs to its present factor.
template <class V, int B>
struct Solver {
    Solver(const Layout& layout, std::size_t hangers) : matrix(layout, hangers) {}
    Preconditioner<V, B> matrix;
    ContactColumns<B> contacts;
};
using Apart = Solver<Floats, 6>;      // wires apart, joined by the droppers' rank-one parts
using Coupled = Solver<Doubles, 12>;  // wires in one factor, for full Newton

class LineEngine final : public Engine {
public:
    LineEngine(const LineData& data, const Scheme& scheme)
        : scheme_(scheme), weight_(1.0 + scheme.alpha),
          sweeps_(data, weight_, {scheme.time_step, scheme.gamma * scheme.time_step,
                                  scheme.beta * scheme.time_step * scheme.time_step}) {}
    ~LineEngine() override {
        for (int i = 0; i < count_; ++i) delete pantographs_[i];
        delete apart_;
        delete coupled_;
    }

    // Factor the matrix of the static state.
    bool prepare() {
        return scheme_.full_newton || factor(dynamic_factors(), sweeps_.line.position, scheme_.coupled, Droppers::all);
    }

    int add_pantograph(const PantographData& data) override {
        if (count_ == kMostPantographs) return -1;
        pantographs_[count_] = new Pantograph(data, scheme_);
        stages_ += data.stages;
        return count_++;
    }
    Outcome advance(const Chunk& chunk, int& done) override;
    bool start_from(const double* q, const double* v) override;
    void coordinates(double* out) const override { gather(sweeps_.q_p, sweeps_.c.to_position, out); }
    void velocities(double* out) const override { gather(sweeps_.v_p, sweeps_.c.to_velocity, out); }
    Counters counters() const override { return counters_; }

private:
    Outcome step(const Chunk& chunk, int index);
    bool touch_all();
    template <class S>
    double iterate(S& solver, bool first);
    bool factor(const Factors& factors, const Buffer<Row>& state, bool coupled, Droppers droppers);
    bool factor_here(bool full_newton);
    Factors dynamic_factors() const {
        return {1.0, sweeps_.c.to_velocity, sweeps_.c.to_position};
    }
    bool accept();
    void carry_over();
    void record(const Chunk& chunk, int index) const;
    void record_droppers(double* out) const;
    void save();
    void restore();
    void gather(const Buffer<Row>& base, double factor, double* out) const;
    void scatter(const double* in, Buffer<Row>& out) const;

    WireView wire() const {
        const Coefficients& c = sweeps_.c;
        const double dt = c.time_step;
        if (!pending_) return {sweeps_, 0.0, c.to_position};
        return {sweeps_, dt, dt * c.to_velocity + 0.5 * dt * dt + c.to_position};
    }

    Scheme scheme_;
    double weight_;
    Sweeps sweeps_;
    Apart* apart_ = nullptr;
    Coupled* coupled_ = nullptr;
    Pantograph* pantographs_[kMostPantographs] = {};
    int count_ = 0, stages_ = 0;
    TouchList touches_;
    bool pending_ = false;  // the next sweep moves the state on to the end of the step
    Counters counters_ = {};
    mutable Buffer<Doubles> dropper_rows_{static_cast<std::size_t>(sweeps_.line.layout.rows)};
    Buffer<Row> saved_[4];  // q_p, v_p, a, known
};

inline Outcome LineEngine::advance(const Chunk& chunk, int& done) {
    save();
    for (done = 0; done < chunk.steps; ++done) {
        const Outcome outcome = step(chunk, done);
        if (outcome != Outcome::running) {
            // Go back to the last good state by repeating the chunk up to it.
            restore();
            for (int i = 0; i < done; ++i) step(chunk, i);
            return outcome;
        }
        record(chunk, done);
    }
    return Outcome::running;
}

inline Outcome LineEngine::step(const Chunk& chunk, int index) {
    touches_.count = 0;
    std::ptrdiff_t stage = static_cast<std::ptrdiff_t>(index) * stages_;
    for (int i = 0; i < count_; stage += pantographs_[i++]->stages()) {
        if (!chunk.on_line[index * count_ + i]) continue;
        pantographs_[i]->predict(chunk.before + stage, chunk.after + stage);
        touches_.add(i, chunk.position[index * count_ + i]);
    }
    Watchdog watch(scheme_.full_newton);
    pending_ = !watch.full_newton;
    if (watch.full_newton) sweeps_.predict();
    for (int n = 0; n < scheme_.iterations; ++n) {
        if (!touch_all()) return Outcome::off_the_line;
        const bool fresh = n == 0 || watch.wants_factor;
        if (watch.wants_factor && !factor_here(watch.full_newton)) return Outcome::singular;
        const double increment = watch.full_newton || scheme_.coupled ? iterate(*coupled_, fresh)
                                                                      : iterate(*apart_, fresh);
        ++counters_.iterations;
        if (std::isnan(increment)) return Outcome::not_finite;
        if (increment <= scheme_.tolerance && watch.count > 0) {
            counters_.full_newton_steps += watch.full_newton;
            return accept() ? Outcome::running : Outcome::off_the_line;
        }
        watch.observe(increment);
    }
    return Outcome::not_converged;
}

inline bool LineEngine::touch_all() {
    const WireView view = wire();
    for (int n = 0; n < touches_.count; ++n) {
        Touch& touch = touches_[n];
        Pantograph& pantograph = *pantographs_[touch.pantograph];
        if (!view.locate(touch, pantograph.element)) return false;
        const double approach = pantograph.head_free - touch.height;
        touch.stiffness = pantograph.stiffness_in_series;
        // A height that is not a number must stay one, so no maximum here.
        touch.force = approach <= 0.0 ? 0.0 : touch.stiffness * approach;
    }
    return true;
}

template <class S>
double LineEngine::iterate(S& solver, bool fresh) {
    touches_.push(sweeps_, weight_);
    if (pending_) {
        sweeps_.eliminate<true>(solver.matrix);
        pending_ = false;
    } else {
        sweeps_.eliminate<false>(solver.matrix);
    }
    touches_.release(sweeps_);
    if (fresh) solver.contacts.set(solver.matrix, touches_);
    solver.contacts.correct(solver.matrix, touches_, weight_ * sweeps_.c.to_position);
    return sweeps_.substitute(solver.matrix);
}

inline bool LineEngine::factor(
    const Factors& factors, const Buffer<Row>& state, bool coupled, Droppers droppers) {
    const Line& line = sweeps_.line;
    Buffer<StationBlocks> blocks(line.layout.stations);
    Assembly(line, blocks).sum(factors, state, coupled ? droppers : Droppers::none);
    const double over_step = factors.stiffness + factors.damping * line.damping_stiffness;
    if (coupled) {
        if (!coupled_) coupled_ = new Coupled(line.layout, line.hangers.size());
        return coupled_->matrix.factor(blocks, state, line, over_step);
    }
    if (!apart_) apart_ = new Apart(line.layout, line.hangers.size());
    return apart_->matrix.factor(blocks, state, line, over_step);
}

inline bool LineEngine::factor_here(bool full_newton) {
    const int rows = sweeps_.line.layout.rows;
    Buffer<Row> state(rows);
    for (int row = 0; row < rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i)
                state[row][wire][i] = sweeps_.q_p[row][wire][i] + sweeps_.c.to_position * sweeps_.a[row][wire][i];
    ++counters_.refactorisations;
    return factor(dynamic_factors(), state, full_newton || scheme_.coupled,
                  full_newton ? Droppers::taut : Droppers::all);
}

inline bool LineEngine::accept() {
    ++counters_.steps;
    if (!touch_all()) return false;
    for (int n = 0; n < touches_.count; ++n) pantographs_[touches_[n].pantograph]->accept(touches_[n].force, touches_[n].element);
    if (scheme_.alpha != 0.0) carry_over();
    return true;
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
    const Layout& layout = sweeps_.line.layout;
    scatter(q, sweeps_.q_p);
    scatter(v, sweeps_.v_p);
    sweeps_.a = Buffer<Row>(layout.rows);
    sweeps_.known.copy_from(sweeps_.line.load);
    if (!factor({1.0, 0.0, 0.0}, sweeps_.q_p, true, Droppers::none)) return false;
    const Coefficients c = sweeps_.c;
    sweeps_.c.to_position = sweeps_.c.to_velocity = 0.0;  // forces at q and v, whatever a is
    for (int n = 0; n < kRefinements; ++n) {
        sweeps_.eliminate<false>(coupled_->matrix);
        sweeps_.substitute(coupled_->matrix);
    }
    sweeps_.c = c;
    for (int row = 0; row < layout.rows; ++row)
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) {
                Doubles& a = sweeps_.a[row][wire][i];
                a *= broadcast<Doubles>(1.0 / weight_);
                sweeps_.q_p[row][wire][i] -= c.to_position * a;
                sweeps_.v_p[row][wire][i] -= c.to_velocity * a;
            }
    if (scheme_.alpha != 0.0) {
        Buffer<Row> inertia(layout.rows);
        sweeps_.inertia(inertia);
        for (int row = 0; row < layout.rows; ++row)
            for (int wire = 0; wire < 2; ++wire)
                for (int i = 0; i < 6; ++i)
                    sweeps_.known[row][wire][i] -= scheme_.alpha * inertia[row][wire][i];
    }
    return !scheme_.coupled || prepare();
}

inline void LineEngine::record(const Chunk& chunk, int index) const {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(index) * count_;
    for (int i = 0; i < count_; ++i) {
        chunk.force[first + i] = pantographs_[i]->force;
        chunk.gap[first + i] = chunk.height[first + i] = std::nan("");
    }
    for (int n = 0; n < touches_.count; ++n) {
        const Touch& touch = touches_[n];
        chunk.height[first + touch.pantograph] = touch.height;
        chunk.gap[first + touch.pantograph] = touch.height - pantographs_[touch.pantograph]->head();
    }
    double* stage = chunk.stages + static_cast<std::ptrdiff_t>(index) * stages_;
    for (int i = 0; i < count_; ++i)
        for (int j = 0; j < pantographs_[i]->stages(); ++j) *stage++ = pantographs_[i]->displacement()[j];
    record_droppers(chunk.dropper_force + static_cast<std::ptrdiff_t>(index) * sweeps_.line.dropper_count);
    const WireView view = wire();
    double* out = chunk.coordinates + static_cast<std::ptrdiff_t>(index) * chunk.observed;
    for (int i = 0; i < chunk.observed; ++i) {
        const int dof = static_cast<int>(chunk.observed_dofs[i]);
        *out++ = view.at(dof / 12, dof % 12 / 6, dof % 6);
    }
}

inline void LineEngine::record_droppers(double* out) const {
    const Line& line = sweeps_.line;
    const Coefficients& c = sweeps_.c;
    Buffer<Doubles>& force = dropper_rows_;
    for (int row = 0; row < line.layout.rows; ++row) {
        if (line.hanger_of[row] < 0) continue;
        Doubles t[3], rate[3];
        for (int i = 0; i < 3; ++i) {
            const Doubles a = sweeps_.a[row][1][i] - sweeps_.a[row][0][i];
            t[i] = sweeps_.q_p[row][1][i] - sweeps_.q_p[row][0][i] + c.to_position * a;
            rate[i] = sweeps_.v_p[row][1][i] - sweeps_.v_p[row][0][i] + c.to_velocity * a;
        }
        const Doubles length = square_root(dot(t, t));
        force[line.hanger_of[row]] =
            dropper_force(line.hangers[line.hanger_of[row]], length, dot(t, rate) / length);
    }
    for (int i = 0; i < line.dropper_count; ++i)
        out[i] = force[line.hanger_of[line.dropper_row[i]]][line.dropper_lane[i]] / weight_;
}

inline void LineEngine::save() {
    const Buffer<Row>* state[4] = {&sweeps_.q_p, &sweeps_.v_p, &sweeps_.a, &sweeps_.known};
    for (int n = 0; n < 4; ++n) {
        if (saved_[n].size() == 0) saved_[n] = Buffer<Row>(state[n]->size());
        saved_[n].copy_from(*state[n]);
    }
    for (int i = 0; i < count_; ++i) pantographs_[i]->save();
}

inline void LineEngine::restore() {
    Buffer<Row>* state[4] = {&sweeps_.q_p, &sweeps_.v_p, &sweeps_.a, &sweeps_.known};
    for (int n = 0; n < 4; ++n) state[n]->copy_from(saved_[n]);
    for (int i = 0; i < count_; ++i) pantographs_[i]->restore();
}

inline void LineEngine::gather(const Buffer<Row>& base, double factor, double* out) const {
    const Layout& layout = sweeps_.line.layout;
    for (int dof = 0; dof < 12 * layout.stations; ++dof) {
        const int row = layout.row(dof / 12), lane = layout.lane(dof / 12);
        const int wire = dof % 12 / 6, i = dof % 6;
        out[dof] = base[row][wire][i][lane] + factor * sweeps_.a[row][wire][i][lane];
    }
}

inline void LineEngine::scatter(const double* in, Buffer<Row>& out) const {
    const Layout& layout = sweeps_.line.layout;
    for (int dof = 0; dof < 12 * layout.stations; ++dof)
        out[layout.row(dof / 12)][dof % 12 / 6][dof % 6][layout.lane(dof / 12)] = in[dof];
}

}  // namespace tautwire::TAUTWIRE_ISA
