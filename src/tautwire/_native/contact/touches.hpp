// The contacts of one step: pairs of a pantograph and a path that meet in the plane of contact.
//
// A pair presses with f = k max(0, head - surface). The head yields under the sum of its forces, so
// all pairs of a pantograph are found together:
//
//     f_i = k_i max(0, approach_i - compliance sum f_j).
#pragma once

#include "contact/pantograph.hpp"
#include "contact/path.hpp"

namespace tautwire::TAUTWIRE_ISA {

struct Touch {
    int pantograph, path;
    ContactPlane plane;
    double rise;  // height of the running surface above the wire
    WirePoint point;
    bool meets;  // the wire is within the reach of the head
    double stiffness, force;

    double surface() const { return point.height + rise; }
};

class TouchList {
public:
    int count() const { return static_cast<int>(touches_.size()); }
    void clear() { touches_.shorten(0); }
    void add(const Touch& touch) { touches_.push(touch); }
    Touch& operator[](int n) { return touches_[n]; }
    const Touch& operator[](int n) const { return touches_[n]; }
    const Touch* begin() const { return touches_.begin(); }
    const Touch* end() const { return touches_.end(); }

    // Set the forces of the pairs of a pantograph, which are those from `first` up to `last`.
    void press(int first, int last, double head_free, double compliance);

    // Add the contact forces to the forces on the nodes; release takes them away again, exactly.
    void push(const Layout& layout, Buffer<Row>& force, double weight);
    void release(const Layout& layout, Buffer<Row>& force);

    // Set the contacts of a matrix; kappa of a contact is `factor` times its stiffness.
    template <class P>
    void set_columns(P& matrix, double factor, const Pantograph* const* pantographs) const;
    // Which contacts are closed, and what stands in a matrix in place of their compliance (see
    // Couplings), set by `close`.
    void close(double factor, const Pantograph* const* pantographs);
    const bool* closed() const { return closed_.data(); }
    const double* compliance() const { return compliance_.data(); }

private:
    static constexpr int kPlaces = 12;  // r and r' of the two nodes of an element

    List<Touch> touches_;
    Buffer<double> before_, compliance_;
    Buffer<bool> closed_;
};

inline void TouchList::press(int first, int last, double head_free, double compliance) {
    double total = 0.0, before = -1.0;
    // The closed pairs only become fewer, so this ends.
    for (int n = first; n < last; ++n) touches_[n].force = 1.0;
    while (total != before) {
        double stiffness = 0.0, push = 0.0;
        for (int n = first; n < last; ++n) {
            Touch& touch = touches_[n];
            const double approach = head_free - touch.surface();
            // A height that is not a number must stay one, so no maximum here.
            if (!touch.meets || approach - compliance * total <= 0.0) touch.force = 0.0;
            if (touch.force == 0.0) continue;
            stiffness += touch.stiffness;
            push += touch.stiffness * approach;
        }
        before = total;
        total = push / (1.0 + compliance * stiffness);
        if (total != total) break;
    }
    for (int n = first; n < last; ++n)
        if (touches_[n].force != 0.0)
            touches_[n].force = touches_[n].stiffness *
                                (head_free - touches_[n].surface() - compliance * total);
}

inline void TouchList::push(const Layout& layout, Buffer<Row>& force, double weight) {
    if (before_.size() < touches_.size() * kPlaces) before_ = Buffer<double>(2 * touches_.size() * kPlaces);
    for (int n = 0; n < count(); ++n) {
        const Touch& touch = touches_[n];
        for (int k = 0; k < kPlaces; ++k) {  // node, r or r', component
            const int side = k / 6, i = k % 6;
            double& place = value(force, layout, touch.point.element + side, i);
            before_[n * kPlaces + k] = place;
            place += weight * touch.force * touch.point.row[2 * side + i / 3] * touch.plane.b[i % 3];
        }
    }
}

inline void TouchList::release(const Layout& layout, Buffer<Row>& force) {
    for (int n = count() - 1; n >= 0; --n)
        for (int k = kPlaces - 1; k >= 0; --k)
            value(force, layout, touches_[n].point.element + k / 6, k % 6) = before_[n * kPlaces + k];
}

template <class P>
void TouchList::set_columns(P& matrix, double factor, const Pantograph* const* pantographs) const {
    matrix.clear_contacts();
    for (const Touch& touch : touches_) {
        double rhs[2][6];
        for (int side = 0; side < 2; ++side) {
            double position[3], slope[3];
            for (int i = 0; i < 3; ++i) {
                position[i] = touch.point.row[2 * side] * touch.plane.b[i];
                slope[i] = touch.point.row[2 * side + 1] * touch.plane.b[i];
            }
            matrix.turn_back(touch.point.element + side, position);
            matrix.turn_back(touch.point.element + side, slope);
            for (int i = 0; i < 3; ++i) {
                rhs[side][i] = position[i];
                rhs[side][3 + i] = slope[i];
            }
        }
        const double k = touch.stiffness;
        const double in_series = k / (1.0 + k * pantographs[touch.pantograph]->compliance());
        matrix.add_contact(touch.point.element, rhs, factor * in_series);
    }
}

// The gradient of the touched height is taken as the vector of the force; its small component along
// the track matters in the residual only.
inline void TouchList::close(double factor, const Pantograph* const* pantographs) {
    const int n = count();
    if (closed_.size() < static_cast<std::size_t>(n)) closed_ = Buffer<bool>(2 * n);
    if (compliance_.size() < static_cast<std::size_t>(n * n)) compliance_ = Buffer<double>(4 * n * n);
    for (int i = 0; i < n; ++i) {
        closed_[i] = touches_[i].force > 0.0;
        for (int j = 0; j < n; ++j) {
            double entry = i == j ? 1.0 / touches_[i].stiffness : 0.0;
            if (touches_[i].pantograph == touches_[j].pantograph)
                entry += pantographs[touches_[i].pantograph]->compliance();
            compliance_[i * n + j] = entry / factor;
        }
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
