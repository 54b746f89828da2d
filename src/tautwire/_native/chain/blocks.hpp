// The chain of all nodes as a block-tridiagonal matrix in double precision, and its factor.
#pragma once

#include "simd/simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

struct NodeBlocks {
    double diagonal[6][6];
    double next[6][6];  // rows of this node, columns of the next
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

// Block LDL' factors D^-1 and L of one node from those of its left neighbour. Where a wire ends,
// `next` is zero, and so is L.
class NodeFactor {
public:
    double inverse[6][6];  // D^-1
    double lower[6][6];    // L, couples to the left neighbour

    bool eliminate(const NodeBlocks& here, const NodeBlocks* left) {
        double schur[6][6];
        std::memcpy(schur, here.diagonal, sizeof(schur));
        if (left) {
            couple(left->next);
            for (int i = 0; i < 6; ++i)
                for (int l = 0; l < 6; ++l)
                    for (int j = 0; j < 6; ++j) schur[i][j] -= lower[i][l] * left->next[l][j];
        } else {
            std::memset(lower, 0, sizeof(lower));
        }
        std::memcpy(inverse, schur, sizeof(schur));
        return invert(inverse);
    }

private:
    // L = A(here, left) D(left)^-1; `inverse` still belongs to the left neighbour.
    void couple(const double (&next)[6][6]) {
        for (int i = 0; i < 6; ++i) {
            double row[6] = {};
            for (int l = 0; l < 6; ++l)
                for (int j = 0; j < 6; ++j) row[j] += next[l][i] * inverse[l][j];
            std::memcpy(lower[i], row, sizeof(row));
        }
    }
};

}  // namespace tautwire::TAUTWIRE_ISA
