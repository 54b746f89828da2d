// The exact matrix of the line in double precision, for full Newton and for the mass matrix.
//
// Nodes are ordered along the track, whatever wire they belong to, so that couplings stay close to
// the diagonal. It is needed rarely; the fast way is the preconditioner.
#pragma once

#include "chain/assembly.hpp"
#include "chain/skyline.hpp"

namespace tautwire::TAUTWIRE_ISA {

class ExactSolver {
public:
    static constexpr bool kSingleBending = false;  // see Preconditioner

    ExactSolver(const Line& line, const Attachments& attached, const Buffer<int>& rank)
        : line_(line), attached_(attached), rank_(rank), x_(6 * static_cast<std::size_t>(rank.size())) {}

    // Factor M + c C + k K in a state with velocities; false when it is not positive definite.
    bool factor(const Factors& factors, const Buffer<Row>& state, const Buffer<Row>& velocity);

    // The contacts: clear, then add the direction in which each one acts on `node` and the next.
    void clear_contacts() { contacts_.shorten(0); }
    void add_contact(int node, const double (&rhs)[2][6], double kappa);
    int contacts() const { return static_cast<int>(contacts_.size()); }
    // Turn a vector of a node to the orientation of the reference state: it is the present one.
    void turn_back(int, double (&)[3]) const {}

    // The calls of a preconditioner. This solver is asked for all rows at once, never for some of
    // them; it solves between the sweeps, with the contacts that are closed.
    void pass(int, bool) {}
    void set_rotation(int, const Row&) {}
    TAUTWIRE_INLINE void eliminate(int row, bool starts, const Row& r);
    void end_run(int, const Run&) {}
    bool is_local() const { return true; }
    void finish_elimination(const RowSet&, int) {}
    void project(const RowSet&, int) {}
    bool solve_couplings(const bool* closed, const double* compliance);
    void apply_couplings(const RowSet&, int) {}
    struct Local {};
    void begin_substitution(const RowSet&, const Run&, Local&) const {}
    TAUTWIRE_INLINE void substitute(int row, Local&, Row& out, Floats& size, Floats& total) const;

    double scale = 1.0;  // of the solution

private:
    struct Contact {
        int node;
        double rhs[2][6];
    };

    int place(int node, int i) const { return 6 * rank_[node] + i; }
    void add(int row, int column, double entry) {
        if (row >= column) matrix_.at(row, column) += entry;
    }
    void add_pair(int a, int b, const double (&block)[3][3]);
    void connect(int a, int b, Buffer<int>& first) const;
    double along(const Contact& contact, const double* x) const;

    const Line& line_;
    const Attachments& attached_;
    const Buffer<int>& rank_;
    Skyline matrix_;
    Buffer<double> x_;
    List<Contact> contacts_;
};

inline void ExactSolver::connect(int a, int b, Buffer<int>& first) const {
    const int low = rank_[a] < rank_[b] ? rank_[a] : rank_[b];
    for (const int node : {a, b}) first[rank_[node]] = first[rank_[node]] < low ? first[rank_[node]] : low;
}

inline bool ExactSolver::factor(
    const Factors& factors, const Buffer<Row>& state, const Buffer<Row>& velocity) {
    const int nodes = line_.layout.nodes;
    Buffer<int> first(nodes);
    for (int k = 0; k < nodes; ++k) first[k] = k;
    for (int node = 0; node + 1 < nodes; ++node)
        if (line_.joined(node)) connect(node, node + 1, first);
    for (const auto& tie : attached_.ties) connect(tie.upper, tie.lower, first);
    for (const auto& clamp : attached_.clamps) connect(clamp.host, clamp.other, first);
    matrix_.clear();
    for (int k = 0; k < 6 * nodes; ++k) matrix_.add_row(6 * first[k / 6]);
    matrix_.reset(0);
    Buffer<NodeBlocks> blocks(nodes);
    const Assembly assembly(line_, attached_);
    assembly.sum_chain(factors, state, blocks);
    for (int node = 0; node < nodes; ++node)
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j) {
                add(place(node, i), place(node, j), blocks[node].diagonal[i][j]);
                if (node + 1 == nodes || blocks[node].next[i][j] == 0.0) continue;
                add(place(node, i), place(node + 1, j), blocks[node].next[i][j]);
                add(place(node + 1, j), place(node, i), blocks[node].next[i][j]);
            }
    const auto join_nodes = [&](int a, int b, const double(&block)[3][3]) { add_pair(a, b, block); };
    assembly.visit_couplings(factors, state, velocity, join_nodes);
    return matrix_.factor(0);
}

inline void ExactSolver::add_pair(int a, int b, const double (&block)[3][3]) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int side = 0; side < (b < 0 ? 1 : 4); ++side) {
                const int left = side % 2 ? b : a, right = side / 2 ? b : a;
                if (line_.is_held(left, i) || line_.is_held(right, j)) continue;
                add(place(left, i), place(right, j), left == right ? block[i][j] : -block[i][j]);
            }
}

inline void ExactSolver::add_contact(int node, const double (&rhs)[2][6], double) {
    Contact contact{node, {}};
    for (int k = 0; k < 12; ++k)
        if (!line_.is_held(node + k / 6, k % 6)) contact.rhs[k / 6][k % 6] = rhs[k / 6][k % 6];
    contacts_.push(contact);
}

TAUTWIRE_INLINE void ExactSolver::eliminate(int row, bool, const Row& r) {
    for (int piece = 0; piece < kPieces; ++piece) {
        const int node = line_.layout.node(row, piece / kLanes, piece % kLanes);
        if (node >= line_.layout.nodes) continue;
        for (int i = 0; i < 6; ++i) x_[place(node, i)] = r[piece / kLanes][i][piece % kLanes];
    }
}

inline double ExactSolver::along(const Contact& contact, const double* x) const {
    double sum = 0.0;
    for (int k = 0; k < 12; ++k) sum += contact.rhs[k / 6][k % 6] * x[place(contact.node + k / 6, k % 6)];
    return sum;
}

inline bool ExactSolver::solve_couplings(const bool* closed, const double* compliance) {
    matrix_.solve(x_.data());
    const int count = contacts();
    if (count == 0) return true;
    const std::size_t size = x_.size();
    Buffer<double> columns(count * size), share(count);
    Skyline small;
    for (int k = 0; k < count; ++k) small.add_row(0);
    small.reset(0);
    for (int k = 0; k < count; ++k) {
        small.at(k, k) = 1.0;
        if (!closed[k]) continue;
        double* column = &columns[k * size];
        for (int n = 0; n < 12; ++n)
            column[place(contacts_[k].node + n / 6, n % 6)] = contacts_[k].rhs[n / 6][n % 6];
        matrix_.solve(column);
        for (int l = 0; l <= k; ++l)
            if (closed[l]) small.at(k, l) = compliance[k * count + l] + along(contacts_[l], column);
        share[k] = along(contacts_[k], x_.data());
    }
    if (!small.factor(0)) return false;
    small.solve(share.data());
    for (int k = 0; k < count; ++k)
        for (std::size_t n = 0; n < size; ++n) x_[n] -= share[k] * columns[k * size + n];
    return true;
}

TAUTWIRE_INLINE void ExactSolver::substitute(
    int row, Local&, Row& out, Floats& size, Floats& total) const {
    for (int half = 0; half < 2; ++half)
        for (int i = 0; i < 6; ++i) {
            out[half][i] = broadcast<Doubles>(0.0);
            for (int lane = 0; lane < kLanes; ++lane) {
                const int node = line_.layout.node(row, half, lane);
                if (node < line_.layout.nodes) out[half][i][lane] = x_[place(node, i)];
            }
        }
    size = broadcast<Floats>(0.0);
    for (int i = 0; i < 3; ++i) {
        const Floats part = absolute(join(out[0][i], out[1][i]));
        size = maximum(size, part);
        total += part;
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
