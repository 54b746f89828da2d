// Where a station of the line is kept: the line is cut into as many equal segments as there are
// lanes, and row k holds the k-th station of every segment.
#pragma once

#include "engine.hpp"
#include "simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

struct RowRange {
    int first, last;  // both included

    bool contains(int row) const { return first <= row && row <= last; }
};

struct Layout {
    int stations = 0;
    int rows = 0;

    int row(int station) const { return station % rows; }
    int lane(int station) const { return station / rows; }
    RowRange whole() const { return {0, rows - 1}; }

    // Choose segments, up to a twentieth longer than needed, in which the stations with droppers
    // and supports fall into as few rows as possible.
    static Layout of(const LineData& line) {
        const int shortest = (line.stations + kLanes - 1) / kLanes;
        Layout best{line.stations, shortest};
        int fewest = best.attached_rows(line);
        for (int rows = shortest + 1; rows <= shortest + shortest / 20; ++rows) {
            const Layout layout{line.stations, rows};
            const int count = layout.attached_rows(line);
            if (count < fewest) {
                fewest = count;
                best = layout;
            }
        }
        return best;
    }

private:
    int attached_rows(const LineData& line) const {
        Buffer<bool> attached(rows);
        for (int i = 0; i < line.droppers; ++i) attached[row(static_cast<int>(line.dropper_station[i]))] = true;
        for (int i = 0; i < line.arms; ++i) attached[row(static_cast<int>(line.arm_station[i]))] = true;
        for (int i = 0; i < line.springs; ++i) attached[row(static_cast<int>(line.spring_dof[i] / 12))] = true;
        int count = 0;
        for (int k = 0; k < rows; ++k) count += attached[k];
        return count;
    }
};

}  // namespace tautwire::TAUTWIRE_ISA
