// Where a node is kept.
//
// The nodes of all wires lie end to end in one chain, wire after wire. It is cut into as many equal
// pieces as a vector of floats has lanes: row k holds the k-th node of every piece. In double
// precision a row is two vectors, the halves of the pieces. Wires may be cut anywhere; where one
// ends, an element without stiffness and mass follows.
//
// Rows are divided into parts, which threads can work on side by side. The division depends on the
// line alone, so that results do not depend on the threads, and what a thread has worked on mostly stays
// in its cache: parts made anew with equal work in every iteration made two threads no faster and one 5 %
// slower.
#pragma once

#include "engine.hpp"
#include "simd/simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

inline constexpr int kPieces = 2 * kLanes;

struct Slot {
    int row, half, lane;

    int piece() const { return half * kLanes + lane; }
};

// Coordinates, velocities or forces of the nodes of a row.
using Row = Doubles[2][6];

struct Layout {
    int nodes = 0, rows = 0, parts = 1;

    // In a number of parts; by default as many as pay for so many nodes.
    explicit Layout(int nodes_, int parts_ = 0)
        : nodes(nodes_), rows((nodes_ + kPieces - 1) / kPieces),
          parts(parts_ > 0 ? parts_ : rows < kDivided ? 1 : kMostParts) {}

    // The first row of a part of all rows; of the one behind the last, the number of rows.
    int bound(int part) const { return part * rows / parts; }
    int part_of(int row) const {
        int part = 0;
        while (row >= bound(part + 1)) ++part;
        return part;
    }

    Slot slot(int node) const {
        const int piece = node / rows;
        return {node - piece * rows, piece / kLanes, piece % kLanes};
    }
    // The node of a slot; behind the last node there is padding.
    int node(int row, int half, int lane) const { return (half * kLanes + lane) * rows + row; }
    int padded() const { return rows * kPieces; }
    int after(int row) const { return row + 1 < rows ? row + 1 : 0; }
    int before(int row) const { return row > 0 ? row - 1 : rows - 1; }

    // Where the first of a node's six values stands in an array of rows of doubles (floats), as
    // numbers; the next one is kLanes (kPieces) further.
    int in_doubles(int node) const {
        const Slot s = slot(node);
        return (2 * s.row + s.half) * 6 * kLanes + s.lane;
    }
    int in_floats(int node) const {
        const Slot s = slot(node);
        return s.row * 6 * kPieces + s.piece();
    }

private:
    // Fewer rows are not divided by default: each part forms one row twice and solves some twice.
    static constexpr int kDivided = 64;
};

// Rows of one part that follow each other.
struct Run {
    int first, count;

    int last() const { return first + count - 1; }
};

// The rows that an iteration works on: where the residual is formed (elsewhere it is taken to be
// zero), and where the correction is solved for, as flags and as runs. Behind the last row comes the
// first, in which every piece goes on where the piece before it ends.
struct RowSet {
    explicit RowSet(const Layout& layout)
        : formed(layout.rows), solved(layout.rows), formed_before_(layout.rows + 1),
          solved_before_(layout.rows + 1) {
        std::memset(formed.data(), 1, formed.size());
        std::memset(solved.data(), 1, solved.size());
        divide(layout);
    }

    Buffer<unsigned char> formed, solved;  // [row]
    List<Run> runs[kMostParts];            // [part]

    // How many rows are formed (solved for), from one on up to another.
    int count_formed(int first, int last) const { return formed_before_[last + 1] - formed_before_[first]; }
    int count_solved(int first, int last) const { return solved_before_[last + 1] - solved_before_[first]; }
    int formed_rows() const { return formed_before_[formed.size()]; }
    int solved_rows() const { return solved_before_[solved.size()]; }
    // Whether there are rows in several parts.
    bool is_shared() const { return is_shared_; }
    // Divide the rows into runs.
    void divide(const Layout& layout) {
        for (int row = 0; row < layout.rows; ++row) {
            formed_before_[row + 1] = formed_before_[row] + formed[row];
            solved_before_[row + 1] = solved_before_[row] + solved[row];
        }
        int busy = 0;
        for (int part = 0; part < layout.parts; ++part) {
            set_runs(layout, part);
            busy += runs[part].size() > 0;
        }
        is_shared_ = busy > 1;
    }

private:
    void set_runs(const Layout& layout, int part) {
        runs[part].shorten(0);
        const int bound = layout.bound(part + 1);
        for (int row = layout.bound(part), length = 0; row < bound; ++row) {
            length = solved[row] ? length + 1 : 0;
            if (length > 0 && (row + 1 == bound || !solved[row + 1]))
                runs[part].push({row + 1 - length, length});
        }
    }

    Buffer<int> formed_before_, solved_before_;  // [row], and behind the last
    bool is_shared_ = false;
};

// One value of a node in an array of rows.
inline double& value(Buffer<Row>& rows, const Layout& layout, int node, int i) {
    return reinterpret_cast<double*>(rows.data())[layout.in_doubles(node) + i * kLanes];
}
inline double value(const Buffer<Row>& rows, const Layout& layout, int node, int i) {
    return reinterpret_cast<const double*>(rows.data())[layout.in_doubles(node) + i * kLanes];
}

}  // namespace tautwire::TAUTWIRE_ISA
