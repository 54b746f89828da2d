// Unit tests of the compiled kernels at one number of lanes: layout, linear solvers, element.
//
// Built with the option TAUTWIRE_TESTS of CMakeLists.txt, or by any C++20 compiler:
//   c++ -std=c++20 -I src/tautwire/_native -DTAUTWIRE_ISA=tested -DTAUTWIRE_LANES=4 kernel_tests.cpp
#include <cstdio>

#include "chain/exact.hpp"
#include "chain/preconditioner.hpp"
#include "line/forces.hpp"
#include "motion/selection.hpp"

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

// Conversions and gathers, which have instructions of their own, do what loops over lanes do.
void test_lanes() {
    Random random;
    Doubles halves[2];
    double values[4 * kLanes];
    int at[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
        halves[0][lane] = random();
        halves[1][lane] = random();
        at[lane] = (7 * lane + 3) % (4 * kLanes);
    }
    for (double& number : values) number = random();
    const Floats joined = join(halves[0], halves[1]);
    const Doubles found = gather(values, at);
    bool is_joined = true, is_widened = true, is_gathered = true;
    for (int lane = 0; lane < kLanes; ++lane) {
        is_gathered &= found[lane] == values[at[lane]];
        for (int half = 0; half < 2; ++half) {
            const float rounded = static_cast<float>(halves[half][lane]);
            is_joined &= joined[half * kLanes + lane] == rounded;
            is_widened &= widen(joined, half)[lane] == static_cast<double>(rounded);
        }
    }
    expect(is_joined, "two halves are joined in their order");
    expect(is_widened, "a half is widened exactly");
    expect(is_gathered, "values are gathered from their places");
}

// Call work(part) for every part, from the first to the last or the other way round: what threads do
// side by side may be done in any order.
template <class F>
void share(const Layout& layout, bool backwards, const F& work) {
    for (int n = 0; n < layout.parts; ++n) work(backwards ? layout.parts - 1 - n : n);
}

// Every node has a slot of its own, and the offsets into arrays of rows lead to it.
void test_layout() {
    for (int nodes : {2, 3, 7, 16, 61, 200}) {
        const Layout layout(nodes);
        expect(layout.padded() >= nodes, "there is a place for every node");
        bool round_trip = true, offsets = true;
        Buffer<Row> rows(layout.rows);
        for (int node = 0; node < nodes; ++node) {
            const Slot s = layout.slot(node);
            round_trip &= s.row < layout.rows && s.half < 2 && s.lane < kLanes &&
                          layout.node(s.row, s.half, s.lane) == node;
            value(rows, layout, node, 4) = node + 1.0;
            offsets &= rows[s.row][s.half][4][s.lane] == node + 1.0;
        }
        expect(round_trip, "the slot of a node leads back to it");
        expect(offsets, "a value of a node stands in its slot");
    }
}

// Solve a dense system in place by Gaussian elimination; the matrix is positive definite.
void solve_dense(Buffer<double>& a, Buffer<double>& x, int n) {
    for (int k = 0; k < n; ++k)
        for (int i = k + 1; i < n; ++i) {
            const double factor = a[i * n + k] / a[k * n + k];
            if (factor == 0.0) continue;  // most are: the couplings are few
            for (int j = k; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
            x[i] -= factor * x[k];
        }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j) x[k] -= a[k * n + j] * x[j];
        x[k] /= a[k * n + k];
    }
}

// A line of three wires of different lengths beside each other, all with stiffness, damping and mass,
// joined by two ties of which one hangs slack, two clamps on neighbouring nodes, and held; kTimes times
// as long as the shortest.
template <int kTimes>
struct Example {
    static constexpr int kNodes = 41 * kTimes;
    static constexpr int kEnds[3] = {17 * kTimes - 1, 31 * kTimes - 1, 41 * kTimes - 1};
    double length[kNodes - 1], axial[kNodes - 1], bending[kNodes - 1], mass[kNodes - 1];
    double node_mass[kNodes] = {}, load[6 * kNodes] = {}, position[6 * kNodes] = {};
    bool fixed[6 * kNodes] = {};
    std::int64_t rank[kNodes];
    std::int64_t tie_nodes[4] = {kEnds[0] + 4, 6, kEnds[0] + 9, 11}, tie_law[2] = {1, 1};
    double tie_length[2] = {0.9, 1.5}, tie_stiffness[2] = {2e5, 2e5};
    std::int64_t clamp_nodes[4] = {kEnds[0] + 6, kEnds[1] + 5, kEnds[0] + 7, kEnds[1] + 6};
    double clamp_stiffness[2] = {1e7, 1e7}, clamp_offset[6] = {0.0, 0.0, 0.4, 0.0, 0.0, 0.4};
    LineData data = {};

    Example() {
        int first = 0, count = 0;
        for (int wire = 0; wire < 3; ++wire) {
            for (int node = first; node <= kEnds[wire]; ++node) {
                position[6 * node] = 0.7 * (node - first) + 1.3 * wire;
                position[6 * node + 2] = wire == 0 ? 0.0 : wire == 1 ? 1.0 : 1.4;
                position[6 * node + 3] = 1.001;
                if (node == kNodes - 1) break;
                const bool joins = node < kEnds[wire];
                length[node] = joins ? 0.7 / 1.001 : 1.0;
                axial[node] = joins ? 1e7 : 0.0;
                bending[node] = joins ? 120.0 : 0.0;
                mass[node] = joins ? 1.1 : 0.0;
            }
            for (int i = 0; i < 3; ++i) fixed[6 * first + i] = true;
            first = kEnds[wire] + 1;
        }
        for (double x = -1.0; count < kNodes; x += 0.05)  // along the track
            for (int node = 0; node < kNodes; ++node)
                if (position[6 * node] > x && position[6 * node] <= x + 0.05) rank[node] = count++;
        data.nodes = kNodes;
        data.ties = data.clamps = 2;
        data.length = length;
        data.axial_stiffness = axial;
        data.bending_stiffness = bending;
        data.mass = mass;
        data.node_mass = node_mass;
        data.load = load;
        data.position = position;
        data.fixed = fixed;
        data.rank = rank;
        data.tie_nodes = tie_nodes;
        data.tie_law = tie_law;
        data.tie_length = tie_length;
        data.tie_stiffness = tie_stiffness;
        data.clamp_nodes = clamp_nodes;
        data.clamp_stiffness = clamp_stiffness;
        data.clamp_offset = clamp_offset;
        data.damping_mass = 0.0125;
        data.damping_stiffness = 1e-4;
    }
};

// The dense matrix of a line, its contact included: chain blocks and couplings, entry by entry.
void fill_dense(const Line& line, const Attachments& attached, const Factors& factors, int contact,
                const double (&rhs)[2][6], double kappa, Buffer<double>& dense) {
    const int nodes = line.layout.nodes, n = 6 * nodes;
    const Assembly assembly(line, attached);
    Buffer<NodeBlocks> blocks(nodes);
    assembly.sum_chain(factors, line.position, blocks);
    for (int node = 0; node < nodes; ++node)
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j) {
                dense[(6 * node + i) * n + 6 * node + j] += blocks[node].diagonal[i][j];
                if (node + 1 == nodes) continue;
                dense[(6 * node + i) * n + 6 * node + 6 + j] += blocks[node].next[i][j];
                dense[(6 * node + 6 + j) * n + 6 * node + i] += blocks[node].next[i][j];
            }
    const Buffer<Row> still(line.position.size());
    const auto add = [&](int a, int b, const double(&block)[3][3]) {
        for (const int left : {a, b})
            for (const int right : {a, b})
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        if (!line.is_held(left, i) && !line.is_held(right, j))
                            dense[(6 * left + i) * n + 6 * right + j] +=
                                left == right ? block[i][j] : -block[i][j];
    };
    assembly.visit_couplings(factors, line.position, still, add);
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j)
            dense[(6 * contact + i) * n + 6 * contact + j] += kappa * rhs[i / 6][i % 6] * rhs[j / 6][j % 6];
}

// Solve for a right-hand side with a matrix of the line as the sweeps do.
template <class P>
void solve_by(P& matrix, const Layout& layout, const Buffer<double>& b, double kappa, bool backwards,
              Buffer<double>& x) {
    const bool closed[1] = {true};
    const double compliance[1] = {1.0 / kappa};
    Buffer<Row> rows(layout.rows);
    for (int k = 0; k < 6 * layout.nodes; ++k) value(rows, layout, k / 6, k % 6) = b[k];
    const RowSet whole(layout);
    share(layout, backwards, [&](int part) {
        for (const Run& run : whole.runs[part]) {
            for (int row = run.first; row <= run.last(); ++row)
                matrix.eliminate(row, row == run.first, rows[row]);
            matrix.end_run(part, run);
        }
    });
    const bool is_local = matrix.is_local();
    for (int part = 0; !is_local && part < layout.parts; ++part) matrix.finish_elimination(whole, part);
    share(layout, backwards, [&](int part) {
        if (is_local) matrix.finish_elimination(whole, part);
        matrix.project(whole, part);
    });
    expect(matrix.solve_couplings(closed, compliance), "couplings are positive definite");
    share(layout, backwards, [&](int part) { matrix.apply_couplings(whole, part); });
    Floats size = broadcast<Floats>(0.0), total = size;
    share(layout, backwards, [&](int part) {
        for (const Run& run : whole.runs[part]) {
            typename P::Local local;
            matrix.begin_substitution(whole, run, local);
            for (int row = run.last(); row >= run.first; --row)
                matrix.substitute(row, local, rows[row], size, total);
        }
    });
    for (int k = 0; k < 6 * layout.nodes; ++k) x[k] = value(rows, layout, k / 6, k % 6);
}

double distance(const Buffer<double>& x, const Buffer<double>& y) {
    double error = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        error = std::fmax(error, std::fabs(x[k] - y[k]));
        largest = std::fmax(largest, std::fabs(y[k]));
    }
    return error / largest;
}

// A line in parts with one contact, a right-hand side, and the solution of its dense system.
template <int kTimes>
struct Problem {
    static constexpr int kContact = 5, kSize = 6 * Example<kTimes>::kNodes;
    static constexpr double kKappa = 0.05;
    const Factors factors = {1.0, 0.5e-3, 0.25e-6};
    const double rhs[2][6] = {{0.0, 0.0, 0.6, 0.0, 0.0, 0.1}, {0.0, 0.0, 0.4, 0.0, 0.0, -0.1}};
    const Example<kTimes> example;
    const Line line;
    Attachments attached;
    Buffer<int> rank;
    Buffer<double> b, expected;

    explicit Problem(int parts)
        : line(example.data, 1.0, parts), attached(example.data, line), rank(line.layout.nodes), b(kSize),
          expected(kSize) {
        for (int node = 0; node < line.layout.nodes; ++node) rank[node] = static_cast<int>(example.rank[node]);
        check_forces(false);
        check_forces(true);
        Buffer<double> dense(static_cast<std::size_t>(kSize) * kSize);
        fill_dense(line, attached, factors, kContact, rhs, kKappa, dense);
        Random random;
        for (int k = 0; k < kSize; ++k)
            expected[k] = b[k] = example.fixed[k] ? 0.0 : (k % 6 < 3 ? 1.0 : 0.1) * random();
        solve_dense(dense, expected, kSize);
    }

    // The forces of ties and clamps, which tell what acts.
    void check_forces(bool backwards) {
        const Layout& layout = line.layout;
        Buffer<Row> still(layout.rows), force(layout.rows);
        const RowSet whole(layout);
        const MotionView view = {line.position, still, still, 0.0, 0.0, 0.0};
        share(layout, backwards, [&](int part) { attached.evaluate(view, whole, part); });
        share(layout, backwards, [&](int part) { attached.push(force, whole, part); });
        share(layout, backwards, [&](int part) { attached.release(force, whole, part); });
        for (int n = 0; n < 2; ++n)
            expect(attached.acting_ties()[n] == (attached.ties[n].number == 0), "one tie is taut, one slack");
        bool is_clean = true;
        for (int k = 0; k < kSize; ++k) is_clean &= value(force, layout, k / 6, k % 6) == 0.0;
        expect(is_clean, "forces are taken away again exactly");
    }

    // Solve in both orders of parts; return how far the solution is from that of the dense system.
    template <class P>
    double error_of(P& matrix) const {
        Buffer<double> x(kSize), other(kSize);
        solve_by(matrix, line.layout, b, kKappa, false, x);
        solve_by(matrix, line.layout, b, kKappa, true, other);
        bool same = true;
        for (int k = 0; k < kSize; ++k) same &= x[k] == other[k];
        expect(same, "the order in which parts are done changes no bit");
        return distance(x, expected);
    }
};

// Wires with breaks, ties, clamps and a contact: both solvers solve the dense system of the line,
// whole or in parts, which are felt in the next one only or, being short, in more of them.
template <int kTimes>
void test_solvers(int parts, bool are_long) {
    Problem<kTimes> given(parts);
    const Layout& layout = given.line.layout;
    expect(layout.parts == parts, "rows are in as many parts as were asked for");
    const Buffer<Row> still(layout.rows);

    ExactSolver exact(given.line, given.attached, given.rank);
    expect(exact.factor(given.factors, given.line.position, still), "the matrix of a line can be factored");
    exact.add_contact(given.kContact, given.rhs, given.kKappa);
    expect(given.error_of(exact) <= 1e-9, "the exact solver solves the dense system");

    Preconditioner fast(given.line, given.attached, given.rank);
    expect(fast.factor(given.factors, given.line.position), "the chain of a line can be factored");
    expect(fast.is_local() == are_long, "parts are as long as influence reaches, or shorter");
    fast.clear_contacts();
    fast.add_contact(given.kContact, given.rhs, given.kKappa);
    // What is cut off couplings costs 0.002 each; geometric stiffness of ties is left out.
    expect(given.error_of(fast) <= 5e-3, "the preconditioner nearly solves the dense system");
}

// Rows are chosen round the ends of the pieces, and what was learned leaves them out again.
void test_selection(int parts, bool backwards) {
    const Layout layout(61 * kPieces, parts);
    Selection selection(layout);
    Buffer<Floats> sizes(layout.rows);
    const List<int> touched;
    const auto choose = [&] {
        share(layout, backwards, [&](int part) { selection.look(sizes, 1.0f, part); });
        for (Floats& size : sizes) size = broadcast<Floats>(0.0);
        return selection.choose(1.0f, touched, true);
    };
    const auto learn = [&] {
        share(layout, backwards, [&](int part) { selection.learn(sizes, 1.0f, true, part); });
        return selection.overlooked();
    };
    selection.begin(1e-3);
    expect(selection.verifies(), "a first step iterates everywhere");
    expect(!choose(), "nothing is chosen where nothing moves");
    for (const int row : {10, 50}) {  // far from the bounds of both parts
        sizes[row][1] = 2.0f;
        expect(choose() && selection.rows.formed[row], "an increment in one part alone is chosen");
    }
    sizes[0][1] = 2.0f;  // its neighbour is the end of piece 0
    expect(choose(), "an increment above the bound is chosen");
    const RowSet& rows = selection.rows;
    expect(rows.formed[0] && rows.formed[layout.rows - 1] && !rows.formed[30], "with its neighbours");
    bool inside = true;
    for (int row = 0; row < layout.rows; ++row) inside &= rows.solved[row] || !rows.formed[row];
    expect(inside, "what is formed is solved for");
    expect(rows.solved[0] && rows.solved[layout.rows - 1], "the run goes round the end");
    for (int step = 0; step < 40; ++step) {
        sizes[0][1] = 0.01f;
        expect(learn() < 1.0, "nothing was overlooked");
        sizes[0][1] = 2.0f;
        choose();
        sizes[0][1] = 2.0f;
    }
    expect(!choose(), "a small share is learned");
    sizes[0][1] = 3.0f;
    expect(learn() == 3.0, "what is overlooked is told");
}

// Whether runs are the solved rows of their parts, all of them.
bool is_divided(const RowSet& rows, const Layout& layout) {
    int solved = 0, at = 0, busy = 0;
    bool is = true;
    for (int part = 0; part < layout.parts; ++part) {
        busy += rows.runs[part].size() > 0;
        for (const Run& run : rows.runs[part]) {
            is &= run.first >= at && layout.part_of(run.first) == part &&
                  layout.part_of(run.last()) == part;
            at = run.last() + 1;
            solved += run.count;
        }
    }
    return is && solved == rows.solved_rows() && rows.is_shared() == (busy > 1);
}

// Looked at in two parts, increments of any size lead to the same rows as in one, and teach the same.
void test_selection_in_parts() {
    const Layout whole(61 * kPieces, 1), halves(61 * kPieces, 2);
    Selection one(whole), two(halves);
    Buffer<Floats> sizes(whole.rows);
    List<int> touched;
    touched.push(halves.bound(1));
    Random random;
    bool chosen = false, same = true, divided = true;
    for (int step = 0; step < 60; ++step) {
        one.begin(1e-3);
        two.begin(1e-3);
        const bool is_small = step % 3 > 0;  // some steps choose few rows, some nearly all
        for (Floats& size : sizes)
            for (int piece = 0; piece < kPieces; ++piece)
                size[piece] = static_cast<float>(std::pow(std::fabs(random()), is_small ? 40.0 : 2.0));
        const bool everywhere = step % 2 == 0;
        one.learn(sizes, 0.5f, everywhere, 0);
        share(halves, true, [&](int part) { two.learn(sizes, 0.5f, everywhere, part); });
        same &= one.overlooked() == two.overlooked();
        one.look(sizes, 0.5f, 0);
        share(halves, true, [&](int part) { two.look(sizes, 0.5f, part); });
        const bool any = one.choose(0.5f, touched, is_small);
        chosen |= any;
        same &= two.choose(0.5f, touched, is_small) == any;
        for (int row = 0; row < whole.rows; ++row)
            same &= one.rows.formed[row] == two.rows.formed[row] &&
                    one.rows.solved[row] == two.rows.solved[row];
        divided &= is_divided(one.rows, whole) && is_divided(two.rows, halves);
    }
    expect(chosen && same, "parts change neither what is chosen nor what is learned");
    expect(divided, "the chosen rows are divided among the parts");
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

// With the nonlinear part of bending in single precision forces change by no more than some roundings of
// the bending stiffness times the curvature; with strains of up to a half it is as large as the linear one.
void test_precision(const Element& element, const Doubles (&left)[6], const Doubles (&right)[6]) {
    const Element elements[2] = {element, element};
    const Parabola<Doubles> e = parabola(left, right, element.inverse_length);
    const Parabola<Doubles> both[2] = {e, e};
    Parabola<Doubles> exact[2], rounded[2];
    elastic_forces<false>(elements, both, exact);
    elastic_forces<true>(elements, both, rounded);
    double error = 0.0, largest = 0.0;
    for (int k = 0; k < 18; ++k)
        for (int lane = 0; lane < kLanes; ++lane) {
            const int half = k / 9, power = k / 3 % 3, i = k % 3;
            error = std::fmax(error, std::fabs(exact[half].c[power][i][lane] - rounded[half].c[power][i][lane]));
            largest = std::fmax(largest, element.stiffness.bending[lane] * std::fabs(both[half].c[1][i][lane]));
        }
    expect(error > 0.0 && error <= 5e-6 * largest, "single precision is felt in the last digits alone");
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
    test_precision(element, nodes[0], nodes[1]);
    std::printf("%d lanes: largest element force %.10e\n", kLanes, largest);
}

}  // namespace
}  // namespace tautwire::TAUTWIRE_ISA

int main() {
    using namespace tautwire::TAUTWIRE_ISA;
    constexpr int kLong = 2 * kLanes;  // 41 rows with any number of lanes; influence reaches 17
    test_lanes();
    test_layout();
    test_solvers<kLong>(1, true);
    test_solvers<kLong>(2, true);
    test_solvers<1>(1, kLanes == 2);
    test_solvers<1>(2, false);
    test_selection(1, false);
    test_selection(2, false);
    test_selection(2, true);
    test_selection_in_parts();
    test_element();
    return failures == 0 ? 0 : 1;
}
