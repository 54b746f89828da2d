// Where a wire passes through the plane of contact of a pantograph (numerics/contact/path.py).
#pragma once

#include "line/attachments.hpp"

namespace tautwire::TAUTWIRE_ISA {

// A stretch of a wire that pantographs may touch.
struct Path {
    int first, last;  // nodes
    double stiffness;  // of a contact
};

// The plane of contact: a point of it, its normal t along the track, and the direction b in which
// the head rises.
struct ContactPlane {
    double origin[3], t[3], b[3];

    static ContactPlane of(const double* frame) {
        ContactPlane out;
        for (int i = 0; i < 3; ++i) {
            out.origin[i] = frame[i];
            out.t[i] = frame[3 + i];
            out.b[i] = frame[6 + i];
        }
        return out;
    }
};

// The point of a wire in the plane: `row` is the Hermite row of its element on (r1, r1', r2, r2').
struct WirePoint {
    int element;  // its left node
    double row[4], height, lateral;
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

// Coordinates of single nodes.
class WireView {
public:
    WireView(const Line& line, const MotionView& motion) : line_(line), motion_(motion) {}

    double at(int node, int i) const {
        const Layout& layout = line_.layout;
        return value(motion_.q_p, layout, node, i) + motion_.q_of_v * value(motion_.v_p, layout, node, i) +
               motion_.q_of_a * value(motion_.a, layout, node, i);
    }

    // Find the point of a path in a plane, from an element on; false when the path does not reach it.
    bool locate(const Path& path, const ContactPlane& plane, int hint, WirePoint& out) const {
        if (!(ahead(path.first, plane) <= 0.0 && 0.0 <= ahead(path.last, plane))) return false;
        int e = hint < path.first ? path.first : hint > path.last - 1 ? path.last - 1 : hint;
        while (e > path.first && ahead(e, plane) > 0.0) --e;
        while (e < path.last - 1 && ahead(e + 1, plane) <= 0.0) ++e;
        const Slot s = line_.layout.slot(e);
        const double length = line_.element[2 * s.row + s.half].length[s.lane];
        const double along[4] = {ahead(e, plane), slope(e, plane.t), ahead(e + 1, plane),
                                 slope(e + 1, plane.t)};
        position_row(invert(along, length), length, out.row);
        const double* b = plane.b;
        const double side[3] = {b[1] * plane.t[2] - b[2] * plane.t[1],
                                b[2] * plane.t[0] - b[0] * plane.t[2],
                                b[0] * plane.t[1] - b[1] * plane.t[0]};
        out.element = e;
        out.height = out.lateral = 0.0;
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i) {
                const double x = at(e + k / 2, 3 * (k % 2) + i) - (k % 2 ? 0.0 : plane.origin[i]);
                out.height += out.row[k] * x * b[i];
                out.lateral += out.row[k] * x * side[i];
            }
        return true;
    }

private:
    // Distance of a node from the plane, and the rate of a slope along a direction.
    double ahead(int node, const ContactPlane& plane) const {
        double sum = 0.0;
        for (int i = 0; i < 3; ++i) sum += (at(node, i) - plane.origin[i]) * plane.t[i];
        return sum;
    }
    double slope(int node, const double (&t)[3]) const {
        return at(node, 3) * t[0] + at(node, 4) * t[1] + at(node, 5) * t[2];
    }

    // Where the element of nodal values q passes through zero, by Newton's method.
    static double invert(const double (&q)[4], double length) {
        // Both as in numerics/elements/hermite.py, which says why.
        constexpr int kSteps = 20;
        constexpr double kTolerance = 1e-13;
        double xi = -q[0] / (q[2] - q[0]);
        for (int n = 0; n < kSteps; ++n) {
            double row[4], rate[4], value = 0.0, slope = 0.0;
            position_row(xi, length, row);
            slope_row(xi, length, rate);
            for (int i = 0; i < 4; ++i) {
                value += row[i] * q[i];
                slope += rate[i] * q[i];
            }
            const double step = -value / slope;
            xi += step;
            if (std::fabs(step) < kTolerance) break;
        }
        return xi;
    }

    const Line& line_;
    MotionView motion_;
};

}  // namespace tautwire::TAUTWIRE_ISA
