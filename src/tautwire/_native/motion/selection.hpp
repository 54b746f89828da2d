// Where a step needs another iteration after its first.
//
// An iteration leaves a share of the increments around a node that belongs to the state of the wires
// there, and that state changes little from step to step. The share is learned node by node from what
// earlier iterations left. Where it says that the next increment would be much smaller than the bound,
// there is no next iteration; around the contacts, whose force feels every increment, there is one until
// the increments themselves are below the bound. At the latest every kVerify-th step iterates everywhere a
// second time, which shows what was overlooked.
#pragma once

#include "line/layout.hpp"

namespace tautwire::TAUTWIRE_ISA {

class Selection {
public:
    explicit Selection(const Layout& layout)
        : rows(layout), layout_(layout), share_(layout.rows), around_(layout.rows), reach_(layout.rows) {
        forget();
    }

    RowSet rows;  // chosen last

    // Begin a step of a size; what was learned at another one does not count.
    void begin(double time_step) {
        if (time_step != time_step_) forget();
        time_step_ = time_step;
        ++since_whole_;
        grows_ = true;
    }
    // Whether the step is one of those that iterate everywhere.
    bool verifies() const { return since_whole_ >= kVerify; }

    // Look, for all parts, at the increments `sizes` of the last iteration; then choose the rows: kPad
    // around each one where the next increment may exceed kPart of a bound, kTouchPad around touched ones
    // where the last one exceeds the bound, or in any case with `always`. False when there are none.
    void look(const Buffer<Floats>& sizes, float bound, int part);
    bool choose(float bound, const List<int>& touched, bool always);
    // Whether so many rows are chosen that an iteration everywhere costs no more.
    bool is_large() const { return rows.formed_rows() > kLarge * layout_.rows; }

    // Learn in the rows of a part from the increments of the iteration that followed on a choice: in
    // the chosen rows, or everywhere. `overlooked` is the largest increment where none above the
    // bound was expected.
    void learn(const Buffer<Floats>& sizes, float bound, bool everywhere, int part);
    double overlooked() const {
        double largest = 0.0;
        for (int part = 0; part < layout_.parts; ++part)
            largest = largest > overlooked_[part] ? largest : overlooked_[part];
        return largest;
    }
    void note_whole() { since_whole_ = 0; }

    std::size_t state_size() const { return 2 + share_.size() * kNumbers; }
    double* save(double* out) const {
        *out++ = time_step_;
        *out++ = since_whole_;
        std::memcpy(out, share_.data(), share_.size() * sizeof(Floats));
        return out + share_.size() * kNumbers;
    }
    const double* restore(const double* in) {
        time_step_ = *in++;
        since_whole_ = static_cast<int>(*in++);
        std::memcpy(static_cast<void*>(share_.data()), in, share_.size() * sizeof(Floats));
        return in + share_.size() * kNumbers;
    }

private:
    static constexpr std::size_t kNumbers = sizeof(Floats) / sizeof(double);
    // Chosen on AC simple, NAD 9 and 15, and on its graded mesh, where five contacts are lost in
    // 0.2 s. Steps between iterations everywhere: with 8 the error is the same and there are 13 %
    // more iterations everywhere.
    static constexpr int kVerify = 32;
    // Rows to either side where residuals are formed: of a row (3 lets the error of an undamped line's energy
    // grow), and of a touched one (10 take a fifth off the error of the force and form 7 % more rows).
    // Corrections are solved for in some more, into which they fade: 3 and 6 are as good.
    static constexpr int kPad = 4, kTouchPad = 6, kExtend = 4;
    // The share counts this many times. Every iteration that teaches lowers it to kDecay of what it was at
    // most, every step raises it by kGrowth. Chosen together by the energy of an undamped line (theory,
    // solution of a step), the error of the force and the cost: a decay of 0.8 takes 0.96 of the time
    // and doubles the error, 0.95 takes 1.05; a growth of 1.03 leaves the same error and takes 1.06. It is
    // never taken to be less than kLeast, about where single precision ends.
    static constexpr float kSafety = 4.0f, kDecay = 0.9f, kGrowth = 1.003f, kLeast = 1e-3f;
    // Part of the bound that an expected increment may reach; with 0.5 undamped lines gain energy.
    static constexpr float kPart = 0.25f;
    // Increments below this part of the bound are too close to rounding to teach anything.
    static constexpr float kTold = 0.3f;
    // Part of the rows from which on an iteration everywhere costs no more; 0.6 costs the same.
    static constexpr double kLarge = 0.9;

    void forget() {
        for (Floats& share : share_) share = broadcast<Floats>(1.0);
        since_whole_ = kVerify;
    }
    void set_rows();

    Layout layout_;
    Buffer<Floats> share_;   // [row]: kSafety times the share that was left
    Buffer<Floats> around_;  // [row]: largest of the last increments here and in the next rows
    Buffer<int> reach_;      // [row]: to how many rows on either side residuals are formed; -1: none
    double time_step_ = 0.0;
    int since_whole_ = 0;
    bool grows_ = false;  // the next look is the first of its step
    // Of the parts; each on a cache line of its own.
    struct alignas(64) Seen {
        bool any;
    };
    Seen seen_[kMostParts] = {};
    double overlooked_[kMostParts] = {};
};

// Take the largest of three neighbours, round the ends of the pieces too, and see where the next
// increment may exceed the bound.
inline void Selection::look(const Buffer<Floats>& sizes, float bound, int part) {
    const int last = layout_.rows - 1;
    bool any = false;
    for (int row = layout_.bound(part); row < layout_.bound(part + 1); ++row) {
        const Floats before = row > 0 ? sizes[row - 1] : to_next_piece(sizes[last]);
        const Floats after = row < last ? sizes[row + 1] : to_previous_piece(sizes[0]);
        around_[row] = maximum(maximum(before, after), sizes[row]);
        if (grows_) share_[row] = minimum(kGrowth * share_[row], broadcast<Floats>(1.0));
        const bool needed = any_greater(around_[row] * share_[row], broadcast<Floats>(kPart * bound));
        reach_[row] = needed ? kPad : -1;
        any |= needed;
    }
    seen_[part].any = any;
}

inline bool Selection::choose(float bound, const List<int>& touched, bool always) {
    bool any = false;
    grows_ = false;
    for (int part = 0; part < layout_.parts; ++part) any |= seen_[part].any;
    for (const int row : touched) {
        if (!always && largest_lane(around_[row]) <= bound) continue;
        reach_[row] = kTouchPad;
        any = true;
    }
    if (any) set_rows();
    return any;
}

// Set the rows from how far each one reaches.
inline void Selection::set_rows() {
    const int count = layout_.rows;
    std::memset(rows.formed.data(), 0, rows.formed.size());
    std::memset(rows.solved.data(), 0, rows.solved.size());
    for (const bool forward : {true, false}) {
        int row = forward ? 0 : count - 1, left = -kExtend - 1;
        for (int n = 0; n < count + kTouchPad + kExtend; ++n) {  // round the ends, far enough
            left = left - 1 > reach_[row] ? left - 1 : reach_[row] < 0 ? left - 1 : reach_[row];
            rows.formed[row] |= left >= 0;
            rows.solved[row] |= left >= -kExtend;
            row = forward ? layout_.after(row) : layout_.before(row);
        }
    }
    rows.divide(layout_);
}

inline void Selection::learn(
    const Buffer<Floats>& sizes, float bound, bool everywhere, int part) {
    const Floats least = broadcast<Floats>(kLeast), most = broadcast<Floats>(1.0);
    const Floats told = broadcast<Floats>(kTold * bound), none = broadcast<Floats>(0.0);
    Floats overlooked = none;
    for (int row = layout_.bound(part); row < layout_.bound(part + 1); ++row) {
        if (!everywhere && !rows.formed[row]) continue;
        const Floats before = around_[row], share = share_[row];
        const Floats seen = kSafety * sizes[row] / maximum(before, told);
        const Floats learned = minimum(maximum(maximum(kDecay * share, seen), least), most);
        share_[row] = where_greater(before, told, learned, share);
        if (everywhere && reach_[row] < 0) overlooked = maximum(overlooked, sizes[row]);
    }
    overlooked_[part] = largest_lane(overlooked);
}

}  // namespace tautwire::TAUTWIRE_ISA
