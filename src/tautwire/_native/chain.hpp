// Block-tridiagonal solver on lanes: every lane runs through its own segment of the line.
//
// The factor A = L D L' is that of the whole line. Forward and backward substitution start in all
// segments at once, without knowing the neighbour's value; as the influence of that value fades
// within `reach` stations, a short extra sweep puts it right.
#pragma once

#include "blocks.hpp"
#include "layout.hpp"

namespace tautwire::TAUTWIRE_ISA {

// A right-hand side that acts on one element, after forward elimination: w = L^-1 rhs, and
// z = D^-1 w, over the stations to the right until it has faded.
template <int B>
struct PointColumn {
    static constexpr int kStations = 40;
    int first = 0, count = 0, wire = 0;
    double w[kStations][B], z[kStations][B];

    // rhs' A^-1 (rhs of another column)
    double response_to(const PointColumn& other) const {
        double sum = 0.0;
        if (other.wire != wire && B == 6) return sum;
        for (int n = 0; n < count; ++n) {
            const int m = first + n - other.first;
            if (m < 0 || m >= other.count) continue;
            for (int i = 0; i < B; ++i) sum += z[n][i] * other.w[m][i];
        }
        return sum;
    }
};

// The same for a right-hand side on one row, all segments at once; cut off at the segments' ends.
template <class V, int B>
struct RowColumn {
    static constexpr int kRows = 8;
    int first = 0, count = 0;
    V w[kRows][B], z[kRows][B];

    V response() const {  // rhs' A^-1 rhs
        V sum = broadcast<V>(0.0);
        for (int n = 0; n < count; ++n)
            for (int i = 0; i < B; ++i) sum += z[n][i] * w[n][i];
        return sum;
    }
};

// V holds one value per segment (B = 12), or one per segment and wire (B = 6).
template <class V, int B>
class BlockChain {
public:
    using Block = V[B];

    explicit BlockChain(const Layout& layout)
        : layout_(layout),
          lower_(static_cast<std::size_t>(layout.rows + 1) * B * B),
          inverse_(static_cast<std::size_t>(layout.rows) * kTriangle),
          y_(static_cast<std::size_t>(layout.rows) * B) {}

    bool factor(const Buffer<StationBlocks>& blocks);

    // Forward sweep: begin_elimination, call for every row of the range, then finish_elimination. In
    // a part of the line the right-hand side outside is zero, and so is the solution.
    void begin_elimination(RowRange range) { range_ = range; }
    TAUTWIRE_INLINE void eliminate(int row, V (&rhs)[B]) {
        V* y = &y_[row * B];
        if (row > range_.first) subtract_lower(row, &y_[(row - 1) * B], rhs);
        for (int i = 0; i < B; ++i) y[i] = rhs[i];
    }

    // Bring in what the left neighbours' last stations contribute.
    void finish_elimination() {
        if (!is_whole()) return;
        V carry[B];
        for (int i = 0; i < B; ++i) carry[i] = y_[(layout_.rows - 1) * B + i];
        for (int step = 0; step < forward_reach_; ++step) {
            const int row = step % layout_.rows;
            if (row == 0)
                for (V& value : carry) value = to_next_segment(value);
            V change[B];
            for (V& value : change) value = broadcast<V>(0.0);
            subtract_lower(row, carry, change);
            for (int i = 0; i < B; ++i) {
                carry[i] = change[i];
                y_[row * B + i] += change[i];
            }
        }
    }

    // Backward sweep: begin_substitution, then call for the last row to the first.
    void begin_substitution() {
        for (V& value : x_) value = broadcast<V>(0.0);
        if (!is_whole()) return;
        for (int step = backward_reach_ - 1; step >= 0; --step) {
            const int row = step % layout_.rows;
            substitute(row);
            if (row == 0)
                for (V& value : x_) value = to_previous_segment(value);
        }
    }

    TAUTWIRE_INLINE const Block& substitute(int row) {
        const V* lower = &lower_[(row + 1) * B * B];
        V out[B];
        scale(row, &y_[row * B], out);
        TAUTWIRE_UNROLL
        for (int i = 0; i < B; ++i)
            TAUTWIRE_UNROLL
            for (int j = 0; j < B; ++j) out[j] -= lower[i * B + j] * x_[i];
        for (int i = 0; i < B; ++i) x_[i] = out[i];
        return x_;
    }

    // Forward-eliminate a right-hand side on one wire's element between `station` and the next.
    void eliminate_point(int station, int wire, const double (&rhs)[2][6], PointColumn<B>& out) const;

    void eliminate_row(int row, const V (&rhs)[B], RowColumn<V, B>& out) const;

    V respond(const RowColumn<V, B>& column) const {
        V sum = broadcast<V>(0.0);
        for (int n = 0; n < count_in_range(column); ++n)
            for (int i = 0; i < B; ++i) sum += column.z[n][i] * y_[(column.first + n) * B + i];
        return sum;
    }
    void add(const RowColumn<V, B>& column, V factor) {
        for (int n = 0; n < count_in_range(column); ++n)
            for (int i = 0; i < B; ++i) y_[(column.first + n) * B + i] += factor * column.w[n][i];
    }

    // Return (rhs of the column)' A^-1 (present right-hand side).
    double respond(const PointColumn<B>& column) const {
        double sum = 0.0;
        for (int n = 0; n < column.count; ++n) {
            const int row = layout_.row(column.first + n);
            if (!range_.contains(row)) break;
            for (int i = 0; i < B; ++i) sum += column.z[n][i] * y_[row * B + i][lane(column, n)];
        }
        return sum;
    }

    // Add a multiple of the column to the eliminated right-hand side.
    void add(const PointColumn<B>& column, double factor) {
        for (int n = 0; n < column.count; ++n) {
            const int row = layout_.row(column.first + n);
            if (!range_.contains(row)) break;
            for (int i = 0; i < B; ++i) y_[row * B + i][lane(column, n)] += factor * column.w[n][i];
        }
    }

private:
    static constexpr int kTriangle = B * (B + 1) / 2;
    static constexpr int kGroups = B == 6 ? 2 : 1;
    // A carried value is dropped when it has faded by this factor.
    static constexpr double kFaded = B == 6 ? 1e-3 : 1e-10;
    // The same for the columns of contacts and droppers, which decay from about 1.
    static constexpr double kWindowFaded = 1e-2;

    TAUTWIRE_INLINE void subtract_lower(int row, const V* left, V* rhs) const {
        const V* lower = &lower_[row * B * B];
        TAUTWIRE_UNROLL
        for (int j = 0; j < B; ++j)
            TAUTWIRE_UNROLL
            for (int i = 0; i < B; ++i) rhs[i] -= lower[i * B + j] * left[j];
    }

    // out = D^-1 y
    TAUTWIRE_INLINE void scale(int row, const V* y, V (&out)[B]) const {
        const V* inverse = &inverse_[row * kTriangle];
        TAUTWIRE_UNROLL
        for (int j = 0; j < B; ++j) out[j] = inverse[j] * y[0];
        TAUTWIRE_UNROLL
        for (int i = 0; i < B; ++i) {
            if (i > 0) out[i] += inverse[0] * y[i];
            TAUTWIRE_UNROLL
            for (int j = i + 1; j < B; ++j) {
                out[i] += inverse[j - i] * y[j];
                if (i > 0) out[j] += inverse[j - i] * y[i];
            }
            inverse += B - i;
        }
    }

    bool is_whole() const { return range_.first == 0 && range_.last == layout_.rows - 1; }

    // Number of rows of a column, whose first row is in the range, that are in it.
    int count_in_range(const RowColumn<V, B>& column) const {
        const int left = range_.last + 1 - column.first;
        return column.count < left ? column.count : left;
    }

    int lane(const PointColumn<B>& column, int n) const {
        return layout_.lane(column.first + n) + (kGroups == 2 ? kLanes * column.wire : 0);
    }

    void store(int station, int group, const StationFactor<B>& factor);
    int reach(bool forward) const;

    Layout layout_;
    Buffer<V> lower_;    // [row][i][j]; the extra row couples to the next segment
    Buffer<V> inverse_;  // [row][upper triangle]
    Buffer<V> y_;        // [row][i]
    V x_[B];
    RowRange range_{0, -1};
    int forward_reach_ = 0, backward_reach_ = 0;
};

template <class V, int B>
bool BlockChain<V, B>::factor(const Buffer<StationBlocks>& blocks) {
    StationFactor<B> padding = {};
    for (int i = 0; i < B; ++i) padding.inverse[i][i] = 1.0;
    for (int group = 0; group < kGroups; ++group) {
        StationFactor<B> factor;
        for (int s = 0; s < layout_.rows * kLanes; ++s) {
            if (s < layout_.stations) {
                if (!factor.eliminate(blocks[s], s ? &blocks[s - 1] : nullptr, group)) return false;
                store(s, group, factor);
            } else {
                store(s, group, padding);
            }
        }
    }
    for (int i = 0; i < B * B; ++i)
        lower_[layout_.rows * B * B + i] = to_previous_segment(lower_[i]);
    forward_reach_ = reach(true);
    backward_reach_ = reach(false);
    return true;
}

template <class V, int B>
void BlockChain<V, B>::store(int station, int group, const StationFactor<B>& factor) {
    const int row = layout_.row(station), lane = layout_.lane(station) + kLanes * group;
    using Scalar = std::decay_t<decltype(x_[0][0])>;
    V* inverse = &inverse_[row * kTriangle];
    for (int i = 0; i < B; ++i) {
        for (int j = 0; j < B; ++j)
            lower_[(row * B + i) * B + j][lane] = static_cast<Scalar>(factor.lower[i][j]);
        for (int j = i; j < B; ++j) (*inverse++)[lane] = static_cast<Scalar>(factor.inverse[i][j]);
    }
}

// Count the stations after which a value carried across a segment boundary has faded.
template <class V, int B>
int BlockChain<V, B>::reach(bool forward) const {
    V product[B][B];
    for (int i = 0; i < B; ++i)
        for (int j = 0; j < B; ++j) product[i][j] = broadcast<V>(i == j ? 1.0 : 0.0);
    const int most = layout_.rows * (kLanes - 1);
    for (int step = 0; step < most; ++step) {
        const int row = forward ? step % layout_.rows : layout_.rows - step % layout_.rows;
        V next[B][B], largest = broadcast<V>(0.0);
        for (int i = 0; i < B; ++i)
            for (int j = 0; j < B; ++j) {
                next[i][j] = broadcast<V>(0.0);
                for (int l = 0; l < B; ++l)
                    next[i][j] += product[l][j] * lower_[(row * B + (forward ? i : l)) * B +
                                                         (forward ? l : i)];
                largest = maximum(largest, absolute(next[i][j]));
            }
        std::memcpy(product, next, sizeof(next));
        if (largest_lane(largest) < kFaded) return step + 1;
    }
    return most;
}

template <class V, int B>
void BlockChain<V, B>::eliminate_row(int row, const V (&rhs)[B], RowColumn<V, B>& out) const {
    const int left = layout_.rows - row;
    out.first = row;
    out.count = left < RowColumn<V, B>::kRows ? left : RowColumn<V, B>::kRows;
    for (int n = 0; n < out.count; ++n) {
        for (int i = 0; i < B; ++i) out.w[n][i] = n == 0 ? rhs[i] : broadcast<V>(0.0);
        if (n > 0) subtract_lower(row + n, out.w[n - 1], out.w[n]);
        scale(row + n, out.w[n], out.z[n]);
        V size = broadcast<V>(0.0);
        for (const V& value : out.w[n]) size = maximum(size, absolute(value));
        if (largest_lane(size) < kWindowFaded) out.count = n + 1;
    }
}

template <class V, int B>
void BlockChain<V, B>::eliminate_point(
    int station, int wire, const double (&rhs)[2][6], PointColumn<B>& out) const {
    const int offset = B == 6 ? 0 : 6 * wire, left = layout_.stations - station;
    out.first = station;
    out.wire = wire;
    double start = 0.0, y[B] = {};
    for (out.count = 0; out.count < left && out.count < PointColumn<B>::kStations; ++out.count) {
        const int n = out.count, row = layout_.row(station + n), l = lane(out, n);
        double next[B] = {}, size = 0.0;
        if (n < 2)
            for (int i = 0; i < 6; ++i) next[offset + i] = rhs[n][i];
        const V* lower = &lower_[row * B * B];
        if (n > 0)
            for (int i = 0; i < B; ++i)
                for (int j = 0; j < B; ++j) next[i] -= lower[i * B + j][l] * y[j];
        for (int i = 0; i < B; ++i) {
            out.w[n][i] = y[i] = next[i];
            out.z[n][i] = 0.0;
            size += std::fabs(y[i]);
        }
        const V* inverse = &inverse_[row * kTriangle];
        for (int i = 0; i < B; ++i)
            for (int j = i; j < B; ++j, ++inverse) {
                out.z[n][i] += (*inverse)[l] * y[j];
                if (j > i) out.z[n][j] += (*inverse)[l] * y[i];
            }
        start = size > start ? size : start;
        if (n > 1 && size < kWindowFaded * start) {
            ++out.count;
            break;
        }
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
