// The kernels of one instruction set; compiled once for each, see CMakeLists.txt.
#include "motion/stepper.hpp"

namespace tautwire::TAUTWIRE_ISA {
namespace {

Engine* make_engine(const LineData& line, const Scheme& scheme) {
    return new LineEngine(line, scheme);
}

// Element arrays from Python: `e` is (4, 3, n), everything with the element last.
struct Cables {
    const double *e, *length, *axial, *bending;
    std::ptrdiff_t n;

    int lanes(std::ptrdiff_t first) const {
        return n - first < kLanes ? static_cast<int>(n - first) : kLanes;
    }

    // Load the elements from `first` on; lanes behind the end repeat the last element.
    Element load(std::ptrdiff_t first, Doubles (&left)[6], Doubles (&right)[6]) const {
        for (int k = 0; k < 6; ++k) {
            left[k] = lanes_of(e + k * n, first);
            right[k] = lanes_of(e + (6 + k) * n, first);
        }
        return Element::of(lanes_of(length, first), lanes_of(axial, first),
                           lanes_of(bending, first), broadcast<Doubles>(0.0));
    }

private:
    Doubles lanes_of(const double* values, std::ptrdiff_t first) const {
        Doubles out = broadcast<Doubles>(values[n - 1]);
        for (int lane = 0; lane < lanes(first); ++lane) out[lane] = values[first + lane];
        return out;
    }
};

void cable_force(int n, const double* e, const double* length, const double* axial,
                 const double* bending, double* out) {
    const Cables cables{e, length, axial, bending, n};
    for (std::ptrdiff_t first = 0; first < n; first += kLanes) {
        Doubles left[6], right[6];
        const Doubles still[6] = {};
        const Element element = cables.load(first, left, right);
        const Parabola<Doubles> f =
            elastic_force(parabola(left, right, element.inverse_length), element.stiffness);
        const Ends ends = wire_forces(element, f, still, still);
        for (int k = 0; k < 12; ++k)
            for (int lane = 0; lane < cables.lanes(first); ++lane)
                out[k * cables.n + first + lane] = k < 6 ? -ends.left[k][lane] : -ends.right[k - 6][lane];
    }
}

void cable_tangent(int n, const double* e, const double* length, const double* axial,
                   const double* bending, double* out) {
    const Cables cables{e, length, axial, bending, n};
    for (std::ptrdiff_t first = 0; first < n; first += kLanes) {
        Doubles left[6], right[6], packed_tangent[kPacked], k[12][12];
        const Element element = cables.load(first, left, right);
        elastic_tangent(parabola(left, right, element.inverse_length), element.stiffness, packed_tangent);
        nodal_tangent(packed_tangent, element, k);
        for (int i = 0; i < 144; ++i)
            for (int lane = 0; lane < cables.lanes(first); ++lane)
                out[i * cables.n + first + lane] = k[i / 12][i % 12][lane];
    }
}

}  // namespace

extern const Backend kBackend;
const Backend kBackend = {TAUTWIRE_NAME, kLanes, make_engine, cable_force, cable_tangent};

}  // namespace tautwire::TAUTWIRE_ISA
