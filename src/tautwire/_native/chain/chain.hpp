// Block-tridiagonal solver on lanes: every lane runs through its own piece of the chain.
//
// The factor A = L D L' is that of the whole chain. Forward and backward substitution start in all
// pieces, and in all parts of them, at once, without knowing the neighbour's value; as the
// influence of that value fades within a few nodes (`reach`), a short extra sweep puts it right.
// The factor is kept in single precision: the solution is corrected until the residual, in double
// precision, is small.
#pragma once

#include "chain/blocks.hpp"
#include "line/layout.hpp"

namespace tautwire::TAUTWIRE_ISA {

class Chain {
public:
    using Block = Floats[6];

    explicit Chain(const Layout& layout)
        : layout_(layout),
          lower_(static_cast<std::size_t>(layout.rows + 1) * 36),
          inverse_(static_cast<std::size_t>(layout.rows) * kTriangle),
          y_(static_cast<std::size_t>(layout.rows) * 6) {}

    bool factor(const Buffer<NodeBlocks>& blocks);

    // Forward sweep: for every run of a part a call for its first row, which `starts` it, to its
    // last, then end_run; when all parts are done, finish_elimination for each of them. Outside the
    // runs the right-hand side is zero, and so is the solution.
    TAUTWIRE_INLINE void eliminate(int row, bool starts, Floats (&rhs)[6]) {
        Floats* y = &y_[row * 6];
        if (!starts) subtract_lower(row, y - 6, rhs);
        for (int i = 0; i < 6; ++i) y[i] = rhs[i];
    }
    void end_run(int part, const Run& run) {
        if (run.last() + 1 != layout_.bound(part + 1)) return;
        for (int i = 0; i < 6; ++i) ends_[part][i] = y_[run.last() * 6 + i];
    }
    // Whether what a part leaves is felt in the next part only, so that parts can be finished side
    // by side.
    bool is_local() const {
        bool is = true;
        for (int part = 0; part < layout_.parts; ++part)
            is &= forward_reach_ <= layout_.bound(part + 1) - layout_.bound(part);
        return is;
    }
    // Bring in what the last rows of the part before contribute.
    void finish_elimination(const RowSet& set, int part) {
        int row = layout_.bound(part);
        if (!set.solved[layout_.before(row)]) return;
        Floats carry[6];
        for (int i = 0; i < 6; ++i) carry[i] = ends_[part > 0 ? part - 1 : layout_.parts - 1][i];
        for (int step = 0; step < forward_reach_ && set.solved[row]; ++step, row = layout_.after(row)) {
            if (row == 0)
                for (Floats& value : carry) value = to_next_piece(value);
            Floats change[6];
            for (Floats& value : change) value = broadcast<Floats>(0.0);
            subtract_lower(row, carry, change);
            for (int i = 0; i < 6; ++i) {
                carry[i] = change[i];
                y_[row * 6 + i] += change[i];
            }
        }
    }

    // Backward sweep: for each run begin_substitution, then a call for its last row to its first,
    // with the solution of the row after, which becomes that of the row.
    void begin_substitution(const RowSet& set, const Run& run, Block& x) const {
        for (Floats& value : x) value = broadcast<Floats>(0.0);
        int row = layout_.after(run.last()), ahead = 0;
        for (; ahead < backward_reach_ && set.solved[row]; ++ahead) row = layout_.after(row);
        for (; ahead > 0; --ahead) {
            row = layout_.before(row);
            substitute(row, x);
            if (row == 0)
                for (Floats& value : x) value = to_previous_piece(value);
        }
    }
    TAUTWIRE_INLINE void substitute(int row, Block& x) const {
        const Floats* lower = &lower_[(row + 1) * 36];
        Floats out[6];
        scale(row, &y_[row * 6], out);
        TAUTWIRE_UNROLL
        for (int i = 0; i < 6; ++i)
            TAUTWIRE_UNROLL
            for (int j = 0; j < 6; ++j) out[j] -= lower[i * 6 + j] * x[i];
        for (int i = 0; i < 6; ++i) x[i] = out[i];
    }

    // The eliminated right-hand side, as numbers (see Layout::in_floats).
    float* eliminated() { return reinterpret_cast<float*>(y_.data()); }

    // Eliminate a right-hand side on `node` and the next: call visit(node, w, z, d) with
    // w = L^-1 rhs, z = D^-1 w and the diagonal d of D^-1, node by node until visit returns false.
    template <class F>
    void eliminate_from(int node, const double (&rhs)[2][6], F visit) const {
        double w[6] = {};
        for (int n = 0; node + n < layout_.nodes; ++n) {
            const Slot s = layout_.slot(node + n);
            const Floats* lower = &lower_[s.row * 36];
            double next[6], z[6] = {}, d[6];
            for (int i = 0; i < 6; ++i) next[i] = n < 2 ? rhs[n][i] : 0.0;
            if (n > 0)
                for (int i = 0; i < 6; ++i)
                    for (int j = 0; j < 6; ++j) next[i] -= lower[i * 6 + j][s.piece()] * w[j];
            std::memcpy(w, next, sizeof(w));
            const Floats* inverse = &inverse_[s.row * kTriangle];
            for (int i = 0; i < 6; ++i)
                for (int j = i; j < 6; ++j, ++inverse) {
                    const double entry = (*inverse)[s.piece()];
                    z[i] += entry * w[j];
                    if (j > i) z[j] += entry * w[i];
                    if (j == i) d[i] = entry;
                }
            if (!visit(node + n, w, z, d)) return;
        }
    }

private:
    static constexpr int kTriangle = 21;  // entries of a symmetric 6x6 block
    // A carried value is dropped when it has faded by this factor. Chosen: 1e-2 and 1e-4 change the
    // iterations of AC simple at 3 ms by 0.1 %.
    static constexpr double kFaded = 1e-3;

    TAUTWIRE_INLINE void subtract_lower(int row, const Floats* left, Floats* rhs) const {
        const Floats* lower = &lower_[row * 36];
        TAUTWIRE_UNROLL
        for (int j = 0; j < 6; ++j)
            TAUTWIRE_UNROLL
            for (int i = 0; i < 6; ++i) rhs[i] -= lower[i * 6 + j] * left[j];
    }

    // out = D^-1 y
    TAUTWIRE_INLINE void scale(int row, const Floats* y, Floats (&out)[6]) const {
        const Floats* inverse = &inverse_[row * kTriangle];
        TAUTWIRE_UNROLL
        for (int j = 0; j < 6; ++j) out[j] = inverse[j] * y[0];
        TAUTWIRE_UNROLL
        for (int i = 0; i < 6; ++i) {
            if (i > 0) out[i] += inverse[0] * y[i];
            TAUTWIRE_UNROLL
            for (int j = i + 1; j < 6; ++j) {
                out[i] += inverse[j - i] * y[j];
                if (i > 0) out[j] += inverse[j - i] * y[i];
            }
            inverse += 6 - i;
        }
    }

    void store(int node, const NodeFactor& factor);
    int reach(bool forward) const;
    int reach_from(int row, bool forward) const;

    Layout layout_;
    Buffer<Floats> lower_;    // [row][i][j]; the extra row couples to the next piece
    Buffer<Floats> inverse_;  // [row][upper triangle]
    Buffer<Floats> y_;        // [row][i]
    Floats ends_[kMostParts][6];  // y of the last rows of the parts, before anything is carried over
    int forward_reach_ = 0, backward_reach_ = 0;
};

inline bool Chain::factor(const Buffer<NodeBlocks>& blocks) {
    NodeFactor padding = {}, factor;
    for (int i = 0; i < 6; ++i) padding.inverse[i][i] = 1.0;
    for (int node = 0; node < layout_.padded(); ++node) {
        if (node >= layout_.nodes) {
            store(node, padding);
        } else {
            if (!factor.eliminate(blocks[node], node ? &blocks[node - 1] : nullptr)) return false;
            store(node, factor);
        }
    }
    for (int i = 0; i < 36; ++i) lower_[layout_.rows * 36 + i] = to_previous_piece(lower_[i]);
    forward_reach_ = reach(true);
    backward_reach_ = reach(false);
    return true;
}

inline void Chain::store(int node, const NodeFactor& factor) {
    const Slot s = layout_.slot(node);
    Floats* inverse = &inverse_[s.row * kTriangle];
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j)
            lower_[(s.row * 6 + i) * 6 + j][s.piece()] = static_cast<float>(factor.lower[i][j]);
        for (int j = i; j < 6; ++j)
            (*inverse++)[s.piece()] = static_cast<float>(factor.inverse[i][j]);
    }
}

// Count the rows after which a value has faded that is carried in at a bound between the parts.
inline int Chain::reach(bool forward) const {
    int most = 0;
    for (int part = 0; part < layout_.parts; ++part) {
        const int rows = reach_from(layout_.bound(part), forward);
        most = most > rows ? most : rows;
    }
    return most;
}

inline int Chain::reach_from(int row, bool forward) const {
    Floats product[6][6];
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) product[i][j] = broadcast<Floats>(i == j ? 1.0 : 0.0);
    const int most = layout_.rows * (kPieces - 1);
    for (int step = 1; step <= most; ++step, row = layout_.after(row)) {
        const Floats* lower = &lower_[row * 36];
        Floats next[6][6], largest = broadcast<Floats>(0.0);
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j) {
                Floats sum = broadcast<Floats>(0.0);
                for (int l = 0; l < 6; ++l)
                    sum += forward ? lower[i * 6 + l] * product[l][j] : product[i][l] * lower[j * 6 + l];
                next[i][j] = sum;
                largest = maximum(largest, absolute(sum));
            }
        if (largest_lane(largest) < kFaded) return step;
        for (int i = 0; i < 36; ++i)
            product[i / 6][i % 6] = row + 1 < layout_.rows ? next[i / 6][i % 6]
                                                           : to_next_piece(next[i / 6][i % 6]);
    }
    return most;
}

}  // namespace tautwire::TAUTWIRE_ISA
