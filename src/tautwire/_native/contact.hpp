// Where pantographs touch the contact wire, and their contacts as a low-rank part of the matrix
// (numerics/contact.py).
#pragma once

#include "preconditioner.hpp"
#include "sweeps.hpp"

namespace tautwire::TAUTWIRE_ISA {

// The touched point: `row` is the Hermite row of its element on (r1, r1', r2, r2').
struct Touch {
    int pantograph, element;
    double x, rise;  // position, and height of the running surface above the wire
    double row[4], height, stiffness, force;
    double before[4];  // known forces on its element without the contact

    double surface() const { return height + rise; }
};

// Hermite shape functions at xi in [0, 1] of an element, or their derivatives with respect to xi.
inline void position_row(double s, double length, double (&row)[4]) {
    row[0] = 1.0 - 3.0 * s * s + 2.0 * s * s * s;
    row[1] = length * (s - 2.0 * s * s + s * s * s);
    row[2] = 3.0 * s * s - 2.0 * s * s * s;
    row[3] = length * (s * s * s - s * s);
}
inline void slope_row(double s, double length, double (&row)[4]) {
    row[0] = -6.0 * s + 6.0 * s * s;
    row[1] = length * (1.0 - 4.0 * s + 3.0 * s * s);
    row[2] = 6.0 * s - 6.0 * s * s;
    row[3] = length * (3.0 * s * s - 2.0 * s);
}

// Coordinates of single nodes: q_p + of_velocity v_p + of_acceleration a.
class WireView {
public:
    WireView(const Line& line, const WireState& state, double of_velocity, double of_acceleration)
        : line_(line), state_(state), of_velocity_(of_velocity), of_acceleration_(of_acceleration) {}
    WireView(const Line& line, const WireState& state) : WireView(line, state, 0.0, state.to_position) {}

    double at(int station, int wire, int i) const {
        const int row = line_.layout.row(station), lane = line_.layout.lane(station);
        return state_.q_p[row][wire][i][lane] + of_velocity_ * state_.v_p[row][wire][i][lane] +
               of_acceleration_ * state_.a[row][wire][i][lane];
    }

    // Find the point at longitudinal position touch.x; false when the wire does not reach there.
    bool locate(Touch& touch, int hint) const {
        const double x = touch.x;
        const int stations = line_.layout.stations;
        if (!(at(0, 0, 0) <= x && x <= at(stations - 1, 0, 0))) return false;
        int e = hint < 0 ? 0 : hint > stations - 2 ? stations - 2 : hint;
        while (e > 0 && x < at(e, 0, 0)) --e;
        while (e < stations - 2 && x >= at(e + 1, 0, 0)) ++e;
        const double length = line_.element[2 * line_.layout.row(e)].length[line_.layout.lane(e)];
        const double q_x[4] = {at(e, 0, 0), at(e, 0, 3), at(e + 1, 0, 0), at(e + 1, 0, 3)};
        const double q_z[4] = {at(e, 0, 2), at(e, 0, 5), at(e + 1, 0, 2), at(e + 1, 0, 5)};
        position_row(invert(q_x, length, x), length, touch.row);
        touch.element = e;
        touch.height = 0.0;
        for (int i = 0; i < 4; ++i) touch.height += touch.row[i] * q_z[i];
        return true;
    }

private:
    static double invert(const double (&q_x)[4], double length, double x) {
        constexpr int kSteps = 20;
        constexpr double kTolerance = 1e-13;
        double xi = (x - q_x[0]) / (q_x[2] - q_x[0]);
        for (int n = 0; n < kSteps; ++n) {
            double row[4], rate[4], value = 0.0, slope = 0.0;
            position_row(xi, length, row);
            slope_row(xi, length, rate);
            for (int i = 0; i < 4; ++i) {
                value += row[i] * q_x[i];
                slope += rate[i] * q_x[i];
            }
            const double step = (x - value) / slope;
            xi += step;
            if (std::fabs(step) < kTolerance) break;
        }
        return xi;
    }

    const Line& line_;
    const WireState& state_;
    double of_velocity_, of_acceleration_;
};

// The contacts of one step.
class TouchList {
public:
    int count = 0;
    void make_room(std::size_t pantographs) { touches_.grow(pantographs); }
    Touch& operator[](int n) { return touches_[n]; }
    const Touch& operator[](int n) const { return touches_[n]; }

    void add(int pantograph, double x, double rise) {
        touches_[count].pantograph = pantograph;
        touches_[count].x = x;
        touches_[count++].rise = rise;
    }

    // Add the contact forces to the known forces; release takes them away again, exactly.
    void push(Sweeps& sweeps, double weight) {
        for (int n = 0; n < count; ++n)
            for (int i = 0; i < 4; ++i) {
                double& force = place(sweeps, n, i);
                touches_[n].before[i] = force;
                force += weight * touches_[n].force * touches_[n].row[i];
            }
    }
    void release(Sweeps& sweeps) {
        for (int n = count - 1; n >= 0; --n)
            for (int i = 3; i >= 0; --i) place(sweeps, n, i) = touches_[n].before[i];
    }

private:
    double& place(Sweeps& sweeps, int n, int i) {
        const int station = touches_[n].element + i / 2;
        const Layout& layout = sweeps.line.layout;
        double* lanes = reinterpret_cast<double*>(&sweeps.known[layout.row(station)][0][i % 2 ? 5 : 2]);
        return lanes[layout.lane(station)];
    }

    Buffer<Touch> touches_;
};

// Contacts in the linear solve: (A + sum kappa n n') x = r by the Sherman-Morrison-Woodbury formula.
// The gradient of the touched height is taken as n, the vector of the force; its small x component
// matters in the residual only.
template <int B>
class ContactColumns {
public:
    template <class P>
    void set(const P& matrix, const TouchList& touches) {
        columns_.grow(touches.count);
        for (int n = 0; n < touches.count; ++n) {
            double rhs[2][6] = {};
            for (int side = 0; side < 2; ++side) {
                double position[3] = {0.0, 0.0, touches[n].row[2 * side]};
                double slope[3] = {0.0, 0.0, touches[n].row[2 * side + 1]};
                matrix.turn_back(touches[n].element + side, 0, position);
                matrix.turn_back(touches[n].element + side, 0, slope);
                for (int i = 0; i < 3; ++i) {
                    rhs[side][i] = position[i];
                    rhs[side][3 + i] = slope[i];
                }
            }
            matrix.chain().eliminate_point(touches[n].element, 0, rhs, columns_[n]);
        }
    }

    // Correct an eliminated right-hand side for the contacts that are closed; kappa is `factor` times
    // the contact's stiffness.
    template <class P>
    void correct(P& matrix, const TouchList& touches, double factor) const {
        Buffer<int> closed(touches.count);
        int count = 0;
        for (int n = 0; n < touches.count; ++n)
            if (touches[n].force > 0.0) closed[count++] = n;
        const int width = count + 1;
        Buffer<double> small(static_cast<std::size_t>(count) * width);
        for (int i = 0; i < count; ++i) {
            const auto& column = columns_[closed[i]];
            double* row = &small[i * width];
            for (int j = 0; j < count; ++j) row[j] = matrix.scale * column.response_to(columns_[closed[j]]);
            row[i] += 1.0 / (factor * touches[closed[i]].stiffness);
            row[count] = matrix.scale * matrix.chain().respond(column);
        }
        solve(small, count);
        for (int i = 0; i < count; ++i)
            matrix.chain().add(columns_[closed[i]], -small[i * width + count]);
    }

private:
    // Gauss-Jordan; the matrix is positive definite. The solution replaces the last column.
    static void solve(Buffer<double>& small, int count) {
        const int width = count + 1;
        for (int k = 0; k < count; ++k) {
            double* pivot = &small[k * width];
            for (int j = count; j >= k; --j) pivot[j] /= pivot[k];
            for (int i = 0; i < count; ++i) {
                double* row = &small[i * width];
                if (i != k)
                    for (int j = count; j >= k; --j) row[j] -= row[k] * pivot[j];
            }
        }
    }

    Buffer<PointColumn<B>> columns_;
};

}  // namespace tautwire::TAUTWIRE_ISA
