// L D L' of a symmetric matrix whose rows begin at their first entry, in double precision.
#pragma once

#include "simd/simd.hpp"

namespace tautwire::TAUTWIRE_ISA {

class Skyline {
public:
    // Begin a matrix; then add rows by the column in which they begin, at most their own number.
    void clear() {
        first_.shorten(0);
        start_.shorten(0);
        length_ = 0;
    }
    void shorten(int rows) {
        if (rows == size()) return;
        length_ = start_[rows];
        first_.shorten(rows);
        start_.shorten(rows);
    }
    void add_row(int first) {
        first_.push(first);
        start_.push(length_);
        length_ += size() - first;
    }
    int size() const { return static_cast<int>(first_.size()); }
    int first(int row) const { return first_[row]; }

    // Make all entries from `row` on zero, to be filled by at(row, column) with column <= row.
    void reset(int row) {
        if (values_.size() < static_cast<std::size_t>(length_)) values_.grow(2 * length_);
        if (row < size())
            std::memset(&values_[start_[row]], 0, (length_ - start_[row]) * sizeof(double));
    }
    double& at(int row, int column) { return values_[start_[row] + column - first_[row]]; }

    // Factor in place from `row` on, the rows before being factored; false when not positive definite.
    bool factor(int row) {
        for (int k = row; k < size(); ++k) {
            double* r = &values_[start_[k]] - first_[k];
            for (int j = first_[k]; j < k; ++j) {
                const double* l = &values_[start_[j]] - first_[j];
                const int from = first_[j] > first_[k] ? first_[j] : first_[k];
                r[j] -= product(r + from, l + from, j - from);
            }
            for (int j = first_[k]; j < k; ++j) {
                const double scaled = r[j] * values_[start_[j] + j - first_[j]];
                r[k] -= r[j] * scaled;
                r[j] = scaled;
            }
            if (!(r[k] > 0.0)) return false;
            r[k] = 1.0 / r[k];
        }
        return true;
    }

    // Solve in place.
    void solve(double* x) const {
        for (int k = 0; k < size(); ++k) {
            if (first_[k] == k) continue;
            const double* l = &values_[start_[k]] - first_[k];
            x[k] -= product(l + first_[k], x + first_[k], k - first_[k]);
        }
        for (int k = 0; k < size(); ++k) x[k] *= values_[start_[k] + k - first_[k]];
        for (int k = size() - 1; k >= 0; --k) {
            const double* l = &values_[start_[k]] - first_[k];
            for (int j = first_[k]; j < k; ++j) x[j] -= l[j] * x[k];
        }
    }

private:
    // Sums in four parts, so that they need not wait for each other.
    static double product(const double* a, const double* b, int n) {
        double sum[4] = {};
        int i = 0;
        for (; i + 4 <= n; i += 4)
            for (int k = 0; k < 4; ++k) sum[k] += a[i + k] * b[i + k];
        for (; i < n; ++i) sum[0] += a[i] * b[i];
        return (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }

    List<int> first_;
    List<std::ptrdiff_t> start_;
    std::ptrdiff_t length_ = 0;
    Buffer<double> values_;  // L below the diagonal, 1/D on it
};

}  // namespace tautwire::TAUTWIRE_ISA
