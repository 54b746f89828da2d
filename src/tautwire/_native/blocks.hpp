// Block-tridiagonal matrix of the line in double precision, station by station, and its factor.
//
// A station is a contact-wire node and a messenger-wire node side by side: 12 degrees of freedom.
// Neighbouring stations are coupled within each wire only; droppers couple the wires of a station.
#pragma once

#include "simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

struct StationBlocks {
    double diagonal[12][12];
    double next[2][6][6];  // per wire: rows of this station, columns of the next
};

// Invert a symmetric positive definite matrix in place; false when it is not.
template <int B>
inline bool invert(double (&a)[B][B]) {
    for (int k = 0; k < B; ++k) {
        const double pivot = a[k][k];
        if (!(pivot > 0.0)) return false;
        const double inverse = 1.0 / pivot;
        a[k][k] = 1.0;
        for (int j = 0; j < B; ++j) a[k][j] *= inverse;
        for (int i = 0; i < B; ++i) {
            if (i == k) continue;
            const double factor = a[i][k];
            a[i][k] = 0.0;
            for (int j = 0; j < B; ++j) a[i][j] -= factor * a[k][j];
        }
    }
    return true;
}

// Block LDL' factors D^-1 and L of one station from those of its left neighbour.
//
// B = 12 factors both wires together; B = 6 one wire, and leaves out the coupling by droppers.
template <int B>
class StationFactor {
public:
    double inverse[B][B];  // D^-1
    double lower[B][B];    // L, couples to the left neighbour

    bool eliminate(const StationBlocks& here, const StationBlocks* left, int wire) {
        const int first = B == 6 ? 6 * wire : 0;
        double schur[B][B];
        for (int i = 0; i < B; ++i)
            for (int j = 0; j < B; ++j) schur[i][j] = here.diagonal[first + i][first + j];
        if (left) {
            couple(*left, wire);
            subtract(*left, wire, schur);
        } else {
            std::memset(lower, 0, sizeof(lower));
        }
        std::memcpy(inverse, schur, sizeof(schur));
        return invert(inverse);
    }

private:
    // L = A(here, left) D(left)^-1; `inverse` still belongs to the left neighbour.
    void couple(const StationBlocks& left, int wire) {
        for (int i = 0; i < B; ++i) {
            const int group = i / 6;
            const auto& next = left.next[B == 6 ? wire : group];
            double row[B] = {};
            for (int l = 0; l < 6; ++l)
                for (int j = 0; j < B; ++j) row[j] += next[l][i % 6] * inverse[6 * group + l][j];
            std::memcpy(lower[i], row, sizeof(row));
        }
    }

    // schur -= L A(left, here)
    void subtract(const StationBlocks& left, int wire, double (&schur)[B][B]) const {
        for (int i = 0; i < B; ++i)
            for (int group = 0; group < B / 6; ++group) {
                const auto& next = left.next[B == 6 ? wire : group];
                for (int l = 0; l < 6; ++l)
                    for (int j = 0; j < 6; ++j)
                        schur[i][6 * group + j] -= lower[i][6 * group + l] * next[l][j];
            }
    }
};

}  // namespace tautwire::TAUTWIRE_ISA
