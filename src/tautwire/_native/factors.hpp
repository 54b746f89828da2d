// Factored matrices of a time step, kept for the steps that come back.
//
// The rule is that of numerics/effective_matrix.py: factors are kept for the steps
// g = dt_0 2^(-j/4); another step uses the factor of the next longer one, scaled.
#pragma once

#include "contact.hpp"

namespace tautwire::TAUTWIRE_ISA {

// A preconditioner and the contacts seen through it.
template <class V, int B>
struct Solver {
    explicit Solver(const Line& line) : matrix(line.layout, line.hangers.size()) {}
    Preconditioner<V, B> matrix;
    ContactColumns<B> contacts;
};
using Apart = Solver<Floats, 6>;      // wires apart, joined by the droppers' rank-one parts
using Coupled = Solver<Doubles, 12>;  // wires in one factor, for full Newton

class StepFactors {
public:
    StepFactors(const Line& line, const Scheme& scheme) : line_(line), scheme_(scheme) {}
    ~StepFactors() {
        for (Kept& kept : kept_) delete kept.solver;
        delete coupled_;
    }
    StepFactors(const StepFactors&) = delete;
    StepFactors& operator=(const StepFactors&) = delete;

    // Make `apart` the solver for steps of a size, factored at the static state when it is new;
    // false when the matrix is not positive definite.
    bool select(double time_step) {
        if (selected_ && time_step == time_step_) return true;
        const int number = static_cast<int>(
            std::floor(kPerOctave * std::log2(scheme_.time_step / time_step) + kSame));
        const double factored = scheme_.time_step * std::exp2(-double(number) / kPerOctave);
        const double share = (time_step / factored) * (time_step / factored);
        selected_ = find(number, factored);
        if (!selected_) return false;
        time_step_ = time_step;
        selected_->last_used = ++uses_;
        selected_->solver->matrix.scale = share > 1.0 - kSame ? 1.0 : 2.0 / (1.0 + share);
        return true;
    }

    Apart& apart() { return *selected_->solver; }
    Coupled& coupled() { return *coupled_; }

    // Factor the selected matrix anew at coordinates q; when it is not positive definite there, it
    // stays that of the static state.
    bool renew(const Buffer<Row>& q) {
        const Factors factors = factors_of(selected_->time_step);
        if (factor(selected_->solver->matrix, factors, q, nullptr)) return true;
        factor(selected_->solver->matrix, factors, line_.position, nullptr);
        return false;
    }
    // Factor the exact tangent at q and v of a step, taut droppers included, as `coupled`.
    bool factor_coupled(const Buffer<Row>& q, const Buffer<Row>& v, double time_step) {
        return make_coupled(factors_of(time_step), q, &v);
    }
    // Factor the mass matrix as `coupled`, to be used at q.
    bool factor_mass(const Buffer<Row>& q) { return make_coupled({1.0, 0.0, 0.0}, q, nullptr); }

private:
    static constexpr int kMost = 12, kPerOctave = 4;
    static constexpr double kSame = 1e-9;

    struct Kept {
        Apart* solver = nullptr;
        int number = 0;
        double time_step = 0.0;
        long last_used = 0;
    };

    Factors factors_of(double time_step) const {
        return {1.0, scheme_.gamma * time_step, scheme_.beta * time_step * time_step};
    }

    // Return the kept solver of a number, or make it in place of the one not used for longest.
    Kept* find(int number, double time_step) {
        Kept* oldest = &kept_[0];
        for (Kept& kept : kept_) {
            if (kept.solver && kept.number == number) return &kept;
            if (kept.last_used < oldest->last_used) oldest = &kept;
        }
        if (!oldest->solver) oldest->solver = new Apart(line_);
        oldest->number = number;
        oldest->time_step = time_step;
        const bool done =
            factor(oldest->solver->matrix, factors_of(time_step), line_.position, nullptr);
        if (done) return oldest;
        delete oldest->solver;
        oldest->solver = nullptr;
        return nullptr;
    }

    bool make_coupled(const Factors& factors, const Buffer<Row>& q, const Buffer<Row>* v) {
        if (!coupled_) coupled_ = new Coupled(line_);
        return factor(coupled_->matrix, factors, q, v);
    }

    template <class P>
    bool factor(P& matrix, const Factors& factors, const Buffer<Row>& q,
                const Buffer<Row>* v) const {
        Buffer<StationBlocks> blocks(line_.layout.stations);
        Assembly(line_, blocks).sum(factors, q, v);
        return matrix.factor(
            blocks, q, line_, factors.stiffness + factors.damping * line_.damping_stiffness);
    }

    const Line& line_;
    Scheme scheme_;
    Kept kept_[kMost];
    Kept* selected_ = nullptr;
    double time_step_ = 0.0;
    long uses_ = 0;
    Coupled* coupled_ = nullptr;
};

}  // namespace tautwire::TAUTWIRE_ISA
