// A lumped-mass pantograph, advanced over a step whose contact force is still unknown.
//
// The stages are linear, so the head height at the end of the step is exactly
// `head_free - compliance * force`.
#pragma once

#include "engine.hpp"
#include "simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

class Pantograph {
public:
    Pantograph(const PantographData& data, const Scheme& scheme)
        : n_(data.stages), scheme_(scheme), start_height_(data.start_height),
          stiffness_(n_ * n_), damping_(n_ * n_), inverse_(n_ * n_), state_(6 * n_) {
        for (int i = 0; i < n_ * n_; ++i) {
            stiffness_[i] = data.stiffness[i];
            damping_[i] = data.damping[i];
            inverse_[i] = data.inverse[i];
        }
        to_position_ = scheme.beta * scheme.time_step * scheme.time_step;
        to_velocity_ = scheme.gamma * scheme.time_step;
        const double compliance = (1.0 + scheme.alpha) * to_position_ * inverse_[0];
        const double k = scheme.contact_stiffness;
        stiffness_in_series = k / (1.0 + k * compliance);
    }

    int stages() const { return n_; }
    const double* displacement() const { return state_.data(); }
    double head() const { return start_height_ + state_[0]; }

    // Advance without contact force at the end of the step.
    void predict(const double* external_before, const double* external_after) {
        const double dt = scheme_.time_step, alpha = scheme_.alpha;
        double *z = state_.data(), *v = z + n_, *a = v + n_;
        double *z_end = a + n_, *v_end = z_end + n_, *load = v_end + n_;
        for (int i = 0; i < n_; ++i) load[i] = alpha * internal(z, v, external_before, i);
        load[0] += alpha * force;
        for (int i = 0; i < n_; ++i) {
            z_end[i] = z[i] + dt * v[i] + dt * dt * (0.5 - scheme_.beta) * a[i];
            v_end[i] = v[i] + dt * (1.0 - scheme_.gamma) * a[i];
        }
        for (int i = 0; i < n_; ++i) load[i] -= (1.0 + alpha) * internal(z_end, v_end, external_after, i);
        head_free = start_height_ + z_end[0] + to_position_ * acceleration(0, load);
    }

    // Make the end of the step, with its contact force, the new state.
    void accept(double contact_force, int touched_element) {
        double *z = state_.data(), *v = z + n_, *a = v + n_;
        double *z_end = a + n_, *v_end = z_end + n_, *load = v_end + n_;
        load[0] -= (1.0 + scheme_.alpha) * contact_force;
        for (int i = 0; i < n_; ++i) a[i] = acceleration(i, load);
        for (int i = 0; i < n_; ++i) {
            z[i] = z_end[i] + to_position_ * a[i];
            v[i] = v_end[i] + to_velocity_ * a[i];
        }
        force = contact_force;
        element = touched_element;
    }

    void save() { saved_ = {copy_of(state_), force, element}; }
    void restore() {
        state_.copy_from(saved_.state);
        force = saved_.force;
        element = saved_.element;
    }

    double stiffness_in_series;  // contact spring and head compliance
    double head_free = 0.0;      // height of the head at the end of the step without contact force
    double force = 0.0;          // contact force at the last accepted instant
    int element = 0;             // element touched last

private:
    struct Saved {
        Buffer<double> state;
        double force = 0.0;
        int element = 0;
    };

    static Buffer<double> copy_of(const Buffer<double>& from) {
        Buffer<double> out(from.size());
        out.copy_from(from);
        return out;
    }

    // C v + K z - external, of stage i.
    double internal(const double* z, const double* v, const double* external, int i) const {
        double sum = -external[i];
        for (int j = 0; j < n_; ++j) sum += damping_[i * n_ + j] * v[j] + stiffness_[i * n_ + j] * z[j];
        return sum;
    }

    double acceleration(int i, const double* load) const {
        double sum = 0.0;
        for (int j = 0; j < n_; ++j) sum += inverse_[i * n_ + j] * load[j];
        return sum;
    }

    int n_;
    Scheme scheme_;
    double start_height_, to_position_, to_velocity_;
    Buffer<double> stiffness_, damping_, inverse_;
    Buffer<double> state_;  // z, v, a; predicted z, v; load of the step
    Saved saved_;
};

}  // namespace tautwire::TAUTWIRE_ISA
