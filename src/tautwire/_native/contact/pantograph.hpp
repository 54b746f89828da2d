// A lumped-mass pantograph, advanced over a step whose contact force is still unknown.
//
// The stages are linear, so the head height at the end of the step is exactly
// `head_free - compliance * force`.
#pragma once

#include "engine.hpp"
#include "simd/simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

class Pantograph {
public:
    Pantograph(const PantographData& data, const Scheme& scheme)
        : n_(data.stages), scheme_(scheme), start_height_(data.start_height), mass_(n_),
          stiffness_(n_ * n_), damping_(n_ * n_), inverse_(n_ * n_), state_(3 * n_), end_(3 * n_),
          load_(n_), reach_{data.reach[0], data.reach[1]} {
        for (int i = 0; i < n_; ++i) mass_[i] = data.mass[i];
        for (int i = 0; i < n_ * n_; ++i) {
            stiffness_[i] = data.stiffness[i];
            damping_[i] = data.damping[i];
        }
    }

    int stages() const { return n_; }
    const double* displacement() const { return state_.data(); }
    // Height that the head loses at the end of a step per contact force.
    double compliance() const { return compliance_; }
    bool reaches(double lateral) const { return reach_[0] <= lateral && lateral <= reach_[1]; }

    // Make ready for steps of a size.
    void set_time_step(double time_step) {
        if (time_step == time_step_) return;
        time_step_ = time_step;
        const double weight = 1.0 + scheme_.alpha;
        to_velocity_ = scheme_.gamma * time_step;
        to_position_ = scheme_.beta * time_step * time_step;
        for (int i = 0; i < n_ * n_; ++i)
            inverse_[i] = weight * (to_velocity_ * damping_[i] + to_position_ * stiffness_[i]);
        for (int i = 0; i < n_; ++i) inverse_[i * n_ + i] += mass_[i];
        invert();
        compliance_ = weight * to_position_ * inverse_[0];
    }

    // Advance without contact force at the end of the step.
    void predict(const double* external_before, const double* external_after) {
        const double dt = time_step_, alpha = scheme_.alpha;
        const double *z = state_.data(), *v = z + n_, *a = v + n_;
        double *z_end = end_.data(), *v_end = z_end + n_;
        for (int i = 0; i < n_; ++i) load_[i] = alpha * internal(z, v, external_before, i);
        load_[0] += alpha * force;
        for (int i = 0; i < n_; ++i) {
            z_end[i] = z[i] + dt * v[i] + dt * dt * (0.5 - scheme_.beta) * a[i];
            v_end[i] = v[i] + dt * (1.0 - scheme_.gamma) * a[i];
        }
        for (int i = 0; i < n_; ++i)
            load_[i] -= (1.0 + alpha) * internal(z_end, v_end, external_after, i);
        head_free = start_height_ + z_end[0] + to_position_ * acceleration(0);
    }

    // Complete the step with its contact force; return the height of the head.
    double finish(double contact_force) {
        double *z = end_.data(), *v = z + n_, *a = v + n_;
        load_[0] -= (1.0 + scheme_.alpha) * contact_force;
        for (int i = 0; i < n_; ++i) a[i] = acceleration(i);
        for (int i = 0; i < n_; ++i) {
            z[i] += to_position_ * a[i];
            v[i] += to_velocity_ * a[i];
        }
        return start_height_ + z[0];
    }

    // Make the completed step the new state.
    void accept() { state_.copy_from(end_); }

    std::size_t state_size() const { return state_.size() + 2; }
    double* save(double* out) const {
        for (std::size_t i = 0; i < state_.size(); ++i) *out++ = state_[i];
        *out++ = force;
        *out++ = gap;
        return out;
    }
    const double* restore(const double* in) {
        for (std::size_t i = 0; i < state_.size(); ++i) state_[i] = *in++;
        force = *in++;
        gap = *in++;
        return in;
    }

    double head_free = 0.0;  // height of the head at the end of the step without contact force
    // At the last accepted instant: force in total, and the smallest gap to a wire.
    double force = 0.0, gap = NAN;

private:
    // C v + K z - external, of stage i.
    double internal(const double* z, const double* v, const double* external, int i) const {
        double sum = -external[i];
        for (int j = 0; j < n_; ++j)
            sum += damping_[i * n_ + j] * v[j] + stiffness_[i * n_ + j] * z[j];
        return sum;
    }

    double acceleration(int i) const {
        double sum = 0.0;
        for (int j = 0; j < n_; ++j) sum += inverse_[i * n_ + j] * load_[j];
        return sum;
    }

    // Gauss-Jordan in place; the effective mass is positive definite.
    void invert() {
        for (int k = 0; k < n_; ++k) {
            double* pivot = &inverse_[k * n_];
            const double scale = 1.0 / pivot[k];
            pivot[k] = 1.0;
            for (int j = 0; j < n_; ++j) pivot[j] *= scale;
            for (int i = 0; i < n_; ++i) {
                if (i == k) continue;
                double* row = &inverse_[i * n_];
                const double factor = row[k];
                row[k] = 0.0;
                for (int j = 0; j < n_; ++j) row[j] -= factor * pivot[j];
            }
        }
    }

    int n_;
    Scheme scheme_;
    double start_height_, time_step_ = 0.0, to_position_ = 0.0, to_velocity_ = 0.0;
    double compliance_ = 0.0;
    Buffer<double> mass_, stiffness_, damping_, inverse_;
    Buffer<double> state_, end_;  // z, v, a
    Buffer<double> load_;
    double reach_[2];
};

}  // namespace tautwire::TAUTWIRE_ISA
