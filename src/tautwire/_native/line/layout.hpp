// Where a node is kept.
//
// The nodes of all wires lie end to end in one chain, wire after wire. It is cut into as many equal
// pieces as a vector of floats has lanes: row k holds the k-th node of every piece. In double
// precision a row is two vectors, the halves of the pieces. Wires may be cut anywhere; where one
// ends, an element without stiffness and mass follows.
//
// The rows are divided into parts, which threads can work on side by side. The division depends on
// the line alone, so that results do not depend on the threads.
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

    explicit Layout(int nodes_)
        : nodes(nodes_), rows((nodes_ + kPieces - 1) / kPieces), parts(rows < kDivided ? 1 : kMostParts) {}

    // The first row of a part; of the one behind the last, the number of rows.
    int bound(int part) const { return part * rows / parts; }
    int part(int row) const { return parts > 1 && row >= bound(1); }

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
    // Fewer rows are not divided: each part forms one row twice and solves some twice.
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
    explicit RowSet(const Layout& layout) : formed(layout.rows), solved(layout.rows) {
        choose_all(layout);
    }

    bool whole = true;
    Buffer<unsigned char> formed, solved;  // [row]
    List<Run> runs[kMostParts];            // [part]

    void choose_all(const Layout& layout) {
        whole = true;
        std::memset(formed.data(), 1, formed.size());
        std::memset(solved.data(), 1, solved.size());
        set_runs(layout);
    }
    // Set the runs from the rows that are solved for.
    void set_runs(const Layout& layout) {
        for (int part = 0; part < layout.parts; ++part) {
            runs[part].shorten(0);
            for (int row = layout.bound(part), length = 0; row < layout.bound(part + 1); ++row) {
                length = solved[row] ? length + 1 : 0;
                if (length > 0 && (row + 1 == layout.bound(part + 1) || !solved[row + 1]))
                    runs[part].push({row + 1 - length, length});
            }
        }
    }
    // Whether the row before a run (after it), in another part then, is solved for too.
    bool continues(const Layout& layout, const Run& run) const { return solved[layout.before(run.first)]; }
    bool is_continued(const Layout& layout, const Run& run) const { return solved[layout.after(run.last())]; }
};

// One value of a node in an array of rows.
inline double& value(Buffer<Row>& rows, const Layout& layout, int node, int i) {
    return reinterpret_cast<double*>(rows.data())[layout.in_doubles(node) + i * kLanes];
}
inline double value(const Buffer<Row>& rows, const Layout& layout, int node, int i) {
    return reinterpret_cast<const double*>(rows.data())[layout.in_doubles(node) + i * kLanes];
}

}  // namespace tautwire::TAUTWIRE_ISA
