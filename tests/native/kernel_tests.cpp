// Unit tests of the compiled kernels at one number of lanes: layout, linear solver, element.
//
// Built with the option TAUTWIRE_TESTS of CMakeLists.txt, or by any C++20 compiler:
//   c++ -std=c++20 -I src/tautwire/_native -DTAUTWIRE_ISA=tested -DTAUTWIRE_LANES=4 kernel_tests.cpp
#include <cstdio>

#include "chain.hpp"
#include "forces.hpp"

namespace tautwire::TAUTWIRE_ISA {
namespace {

int failures = 0;

void expect(bool is_true, const char* claim) {
    if (is_true) return;
    std::fprintf(stderr, "%d lanes: not true: %s\n", kLanes, claim);
    ++failures;
}

// Numbers in (-1, 1) from a linear congruence (Knuth's MMIX), the same on every machine.
class Random {
public:
    double operator()() {
        state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
        return 2.0 * static_cast<double>(state_ >> 11) / 9007199254740992.0 - 1.0;
    }

private:
    std::uint64_t state_ = 1;
};

// Every station has a place of its own, in the order of the line within each lane.
void test_layout() {
    for (int stations : {2, 3, 7, 16, 61, 200}) {
        LineData line = {};
        line.stations = stations;
        const Layout layout = Layout::of(line);
        expect(layout.rows * kLanes >= stations, "there is a place for every station");
        bool round_trip = true;
        for (int s = 0; s < stations; ++s)
            round_trip &= layout.lane(s) < kLanes && layout.row(s) < layout.rows &&
                          layout.lane(s) * layout.rows + layout.row(s) == s;
        expect(round_trip, "row and lane of a station lead back to it");
    }
}

// Solve a dense system in place by Gauss-Jordan elimination; the matrix is positive definite.
void solve_dense(Buffer<double>& a, Buffer<double>& x, int n) {
    for (int k = 0; k < n; ++k)
        for (int i = 0; i < n; ++i) {
            if (i == k) continue;
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
            x[i] -= factor * x[k];
        }
    for (int k = 0; k < n; ++k) x[k] /= a[k * n + k];
}

// A random block-tridiagonal matrix with a dominant diagonal, wires coupled where B is 12.
Buffer<StationBlocks> random_blocks(int stations, bool is_coupled) {
    Random random;
    Buffer<StationBlocks> blocks(stations);
    for (int s = 0; s < stations; ++s) {
        for (int i = 0; i < 12; ++i)
            for (int j = 0; j <= i; ++j) {
                const double entry = is_coupled || i / 6 == j / 6 ? random() : 0.0;
                blocks[s].diagonal[i][j] = blocks[s].diagonal[j][i] = i == j ? 40.0 + entry : entry;
            }
        for (int k = 0; k < 72; ++k) blocks[s].next[k / 36][k / 6 % 6][k % 6] = random();
    }
    return blocks;
}

// The chain of lanes solves the system of the whole line.
template <class V, int B>
void test_chain(double tolerance, const char* claim) {
    const int stations = 37, n = 12 * stations;
    LineData line = {};
    line.stations = stations;
    const Layout layout = Layout::of(line);
    const Buffer<StationBlocks> blocks = random_blocks(stations, B == 12);
    Buffer<double> dense(static_cast<std::size_t>(n) * n), expected(n);
    Random random;
    for (int s = 0; s < stations; ++s)
        for (int i = 0; i < 12; ++i) {
            const int row = 12 * s + i;
            expected[row] = random();
            for (int j = 0; j < 12; ++j) dense[row * n + 12 * s + j] = blocks[s].diagonal[i][j];
            if (s + 1 == stations) continue;
            for (int j = 0; j < 6; ++j) {
                const int column = 12 * (s + 1) + i / 6 * 6 + j;
                dense[row * n + column] = dense[column * n + row] = blocks[s].next[i / 6][i % 6][j];
            }
        }
    BlockChain<V, B> chain(layout);
    expect(chain.factor(blocks), "a positive definite matrix can be factored");
    const auto at = [&](int s, int i) { return B == 6 ? layout.lane(s) + i / 6 * kLanes : layout.lane(s); };
    chain.begin_elimination(layout.whole());
    for (int row = 0; row < layout.rows; ++row) {
        V rhs[B];
        for (V& part : rhs) part = broadcast<V>(0.0);
        for (int s = row; s < stations; s += layout.rows)
            for (int i = 0; i < 12; ++i) rhs[i % B][at(s, i)] = expected[12 * s + i];
        chain.eliminate(row, rhs);
    }
    chain.finish_elimination();
    solve_dense(dense, expected, n);
    chain.begin_substitution();
    double error = 0.0, largest = 0.0;
    for (int row = layout.rows - 1; row >= 0; --row) {
        const auto& x = chain.substitute(row);
        for (int s = row; s < stations; s += layout.rows)
            for (int i = 0; i < 12; ++i) {
                error = std::fmax(error, std::fabs(x[i % B][at(s, i)] - expected[12 * s + i]));
                largest = std::fmax(largest, std::fabs(expected[12 * s + i]));
            }
    }
    expect(error <= tolerance * largest, claim);
}

// Energy of one element per lane from the formula at the head of element.hpp, by the same rule.
Doubles energy(const Doubles (&left)[6], const Doubles (&right)[6], const Element& element,
               double axial, Doubles quadruple_bending) {
    const Parabola<Doubles> f = parabola(left, right, element.inverse_length);
    Doubles sum = broadcast<Doubles>(0.0);
    for (int point = -2; point <= 2; ++point) {
        const int pair = point < 0 ? -point : point;
        const double t = point < 0 ? -kPoint[pair] : kPoint[pair];
        Doubles p[3], h[3];
        for (int i = 0; i < 3; ++i) {
            p[i] = f.c[0][i] + t * (f.c[1][i] + t * f.c[2][i]);
            h[i] = f.c[1][i] + 2.0 * t * f.c[2][i];
        }
        const Doubles P = dot(p, p), H = dot(h, h), Q = dot(p, h), one = broadcast<Doubles>(1.0);
        const Doubles stretch = P - one;
        sum += kWeight[pair] * ((0.125 * axial) * stretch * stretch +
                                0.5 * quadruple_bending * (H / (P * P) - Q * Q / (P * P * P)));
    }
    return sum * element.length;
}

// Elastic forces are minus the gradient of the energy.
void test_element() {
    constexpr double kAxial = 2e4, kBending = 30.0, kStep = 1e-5;
    Random random;
    Doubles nodes[2][6], length;
    const Doubles still[6] = {};
    for (int lane = 0; lane < kLanes; ++lane) {
        length[lane] = 0.7 + 0.2 * random();
        for (int i = 0; i < 6; ++i) {
            nodes[0][i][lane] = (i == 3) + 0.1 * random();
            nodes[1][i][lane] = (i == 3) + (i == 0) * length[lane] + 0.1 * random();
        }
    }
    const Doubles bending = broadcast<Doubles>(kBending);
    const Element element = Element::of(length, broadcast<Doubles>(kAxial), bending, broadcast<Doubles>(0.0));
    const Doubles quadruple = 4.0 * bending / (length * length);
    const Parabola<Doubles> f =
        elastic_force(parabola(nodes[0], nodes[1], element.inverse_length), element.stiffness);
    const Ends ends = wire_forces(element, f, still, still);
    double error = 0.0, largest = 0.0;
    for (int k = 0; k < 12; ++k) {
        const Doubles before = nodes[k / 6][k % 6];
        nodes[k / 6][k % 6] = before + broadcast<Doubles>(kStep);
        const Doubles above = energy(nodes[0], nodes[1], element, kAxial, quadruple);
        nodes[k / 6][k % 6] = before - broadcast<Doubles>(kStep);
        const Doubles below = energy(nodes[0], nodes[1], element, kAxial, quadruple);
        nodes[k / 6][k % 6] = before;
        const Doubles force = k < 6 ? ends.left[k] : ends.right[k - 6];
        for (int lane = 0; lane < kLanes; ++lane) {
            error = std::fmax(error, std::fabs(force[lane] + (above[lane] - below[lane]) / (2.0 * kStep)));
            largest = std::fmax(largest, std::fabs(force[lane]));
        }
    }
    expect(error <= 1e-7 * largest, "elastic forces are minus the gradient of the energy");
    std::printf("%d lanes: largest element force %.10e\n", kLanes, largest);
}

}  // namespace
}  // namespace tautwire::TAUTWIRE_ISA

int main() {
    using namespace tautwire::TAUTWIRE_ISA;
    test_layout();
    test_chain<Doubles, 12>(1e-9, "both wires together: the chain solves the dense system");
    test_chain<Floats, 6>(2e-4, "each wire apart: the chain solves the dense system");
    test_element();
    return failures == 0 ? 0 : 1;
}
