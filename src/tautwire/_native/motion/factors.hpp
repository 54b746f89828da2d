// Factored matrices of a time step, kept for the steps that come back.
//
// The rule is that of numerics/effective_matrix.py: factors are kept for the steps
// g = dt_0 2^(-j/4); another step uses the factor of the next longer one, scaled.
#pragma once

#include "chain/exact.hpp"
#include "chain/preconditioner.hpp"

namespace tautwire::TAUTWIRE_ISA {

class StepFactors {
public:
    StepFactors(const Line& line, const Attachments& attached, const LineData& data,
                const Scheme& scheme)
        : line_(line), attached_(attached), scheme_(scheme), rank_(data.nodes) {
        for (int node = 0; node < data.nodes; ++node) rank_[node] = static_cast<int>(data.rank[node]);
    }
    ~StepFactors() {
        for (Kept& kept : kept_) delete kept.matrix;
        delete exact_;
    }
    StepFactors(const StepFactors&) = delete;
    StepFactors& operator=(const StepFactors&) = delete;

    // Make `fast` the matrix for steps of a size, factored at the static state when it is new;
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
        selected_->matrix->scale = share > 1.0 - kSame ? 1.0 : 2.0 / (1.0 + share);
        return true;
    }

    Preconditioner& fast() { return *selected_->matrix; }
    ExactSolver& exact() { return *exact_; }

    // Factor the selected matrix anew at coordinates q; when it is not positive definite there, it
    // stays that of the static state.
    bool renew(const Buffer<Row>& q) {
        const Factors factors = factors_of(selected_->time_step);
        if (selected_->matrix->factor(factors, q)) return true;
        selected_->matrix->factor(factors, line_.position);
        return false;
    }
    // Factor the exact tangent at q and v of a step as `exact`, or the mass matrix.
    bool factor_exact(const Buffer<Row>& q, const Buffer<Row>& v, double time_step) {
        return make_exact(factors_of(time_step), q, v);
    }
    bool factor_mass(const Buffer<Row>& q) { return make_exact({1.0, 0.0, 0.0}, q, q); }

private:
    // As in numerics/motion/effective_matrix.py, which says why.
    static constexpr int kMost = 12, kPerOctave = 4;
    static constexpr double kSame = 1e-9;

    struct Kept {
        Preconditioner* matrix = nullptr;
        int number = 0;
        double time_step = 0.0;
        long last_used = 0;
    };

    Factors factors_of(double time_step) const {
        return {1.0, scheme_.gamma * time_step, scheme_.beta * time_step * time_step};
    }

    // Return the kept matrix of a number, or make it in place of the one not used for longest.
    Kept* find(int number, double time_step) {
        Kept* oldest = &kept_[0];
        for (Kept& kept : kept_) {
            if (kept.matrix && kept.number == number) return &kept;
            if (kept.last_used < oldest->last_used) oldest = &kept;
        }
        if (!oldest->matrix) oldest->matrix = new Preconditioner(line_, attached_, rank_);
        oldest->number = number;
        oldest->time_step = time_step;
        if (oldest->matrix->factor(factors_of(time_step), line_.position)) return oldest;
        delete oldest->matrix;
        oldest->matrix = nullptr;
        return nullptr;
    }

    bool make_exact(const Factors& factors, const Buffer<Row>& q, const Buffer<Row>& v) {
        if (!exact_) exact_ = new ExactSolver(line_, attached_, rank_);
        return exact_->factor(factors, q, v);
    }

    const Line& line_;
    const Attachments& attached_;
    Scheme scheme_;
    Buffer<int> rank_;
    Kept kept_[kMost];
    Kept* selected_ = nullptr;
    double time_step_ = 0.0;
    long uses_ = 0;
    ExactSolver* exact_ = nullptr;
};

}  // namespace tautwire::TAUTWIRE_ISA
