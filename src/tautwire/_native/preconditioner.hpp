// The matrix of a reference state, turned node by node with the wires: x = R A^-1 R' r.
//
// The stiffest part of a wire, its axial stiffness, turns with the wire. A constant matrix is a poor
// approximation of the tangent after small rotations; turned with the nodes it stays a good one.
#pragma once

#include "chain.hpp"
#include "line.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Turn the vector x by the rotation with axis * sine `w` and scale 1/(1 + cosine).
template <class T>
TAUTWIRE_INLINE void rotate(const T* w, T scale, T* x) {
    const T first[3] = {w[1] * x[2] - w[2] * x[1], w[2] * x[0] - w[0] * x[2],
                        w[0] * x[1] - w[1] * x[0]};
    x[0] += first[0] + scale * (w[1] * first[2] - w[2] * first[1]);
    x[1] += first[1] + scale * (w[2] * first[0] - w[0] * first[2]);
    x[2] += first[2] + scale * (w[0] * first[1] - w[1] * first[0]);
}

template <class V, int B>
class Preconditioner {
public:
    using Vector = V;
    static constexpr int kBlock = B;

    Preconditioner(const Layout& layout, std::size_t hangers)
        : layout_(layout), chain_(layout), tangent_(layout.rows), rotation_(layout.rows),
          hangers_(kHasHangers ? hangers : 0) {}

    BlockChain<V, B>& chain() { return chain_; }
    const BlockChain<V, B>& chain() const { return chain_; }

    // Factor the blocks of a state; false when they are not positive definite. With B = 6 they are
    // without droppers, whose stiffness in the matrix is `over_step` times their own.
    bool factor(const Buffer<StationBlocks>& blocks, const Buffer<Row>& state, const Line& line,
                double over_step) {
        for (int row = 0; row < layout_.rows; ++row)
            for (int g = 0; g < kGroups; ++g) {
                unit(group(g, state[row][0] + 3, state[row][1] + 3), tangent_[row].t[g]);
                for (V& component : rotation_[row].w[g]) component = broadcast<V>(0.0);
                rotation_[row].scale[g] = broadcast<V>(0.5);
            }
        if (!chain_.factor(blocks)) return false;
        if constexpr (kHasHangers) set_hangers(state, line, over_step);
        return true;
    }

    // Set the rotation of a row from the reference tangents to those of the present slopes.
    TAUTWIRE_INLINE void set_rotation(
        int row, const Doubles* contact, const Doubles* messenger) {
        for (int g = 0; g < kGroups; ++g) {
            V t[3];
            unit(group(g, contact, messenger), t);
            const V(&t0)[3] = tangent_[row].t[g];
            V(&w)[3] = rotation_[row].w[g];
            w[0] = t0[1] * t[2] - t0[2] * t[1];
            w[1] = t0[2] * t[0] - t0[0] * t[2];
            w[2] = t0[0] * t[1] - t0[1] * t[0];
            const V cosine = t0[0] * t[0] + t0[1] * t[1] + t0[2] * t[2];
            rotation_[row].scale[g] = one() / (one() + cosine);
        }
    }

    TAUTWIRE_INLINE void eliminate(int row, const Doubles (&r)[2][6]) {
        V x[B];
        if constexpr (B == 6) {
            for (int i = 0; i < 6; ++i) x[i] = join(r[0][i], r[1][i]);
        } else {
            for (int i = 0; i < 12; ++i) x[i] = r[i / 6][i % 6];
        }
        const Rotation& turn = rotation_[row];
        for (int g = 0; g < kGroups; ++g) {
            const V back[3] = {-turn.w[g][0], -turn.w[g][1], -turn.w[g][2]};
            rotate(back, turn.scale[g], x + 6 * g);
            rotate(back, turn.scale[g], x + 6 * g + 3);
        }
        chain_.eliminate(row, x);
    }

    void begin_elimination(RowRange range) {
        range_ = range;
        chain_.begin_elimination(range);
    }

    // Complete the forward elimination; `taut` says which droppers hold the wires together.
    void finish_elimination([[maybe_unused]] const Buffer<Doubles>& taut) {
        chain_.finish_elimination();
        if constexpr (kHasHangers) {
            for (std::size_t n = 0; n < hangers_.size(); ++n) {
                const HangerColumn& hanger = hangers_[n];
                if (!range_.contains(hanger.column.first)) continue;
                const V own = chain_.respond(hanger.column);
                const V both = own + other_wire(own);
                chain_.add(hanger.column, -hanger.share * join(taut[n], taut[n]) * both);
            }
        }
    }

    // Solve for a row, from the last to the first; `size` is the largest |x| of translations lane by
    // lane, and `total` collects them to find values that are not finite.
    TAUTWIRE_INLINE void substitute(int row, Doubles (&out)[2][6], V& size, V& total) {
        V x[B];
        const auto& local = chain_.substitute(row);
        for (int i = 0; i < B; ++i) x[i] = local[i];
        const Rotation& turn = rotation_[row];
        if (scale != 1.0)
            for (V& component : x) component *= broadcast<V>(scale);
        for (int g = 0; g < kGroups; ++g) {
            rotate(turn.w[g], turn.scale[g], x + 6 * g);
            rotate(turn.w[g], turn.scale[g], x + 6 * g + 3);
            for (int i = 0; i < 3; ++i) {
                const V part = absolute(x[6 * g + i]);
                size = g + i == 0 ? part : maximum(size, part);
                total += part;
            }
        }
        for (int i = 0; i < 12; ++i) {
            if constexpr (B == 6) {
                out[i / 6][i % 6] = widen(x[i % 6], i / 6);
            } else {
                out[i / 6][i % 6] = x[i];
            }
        }
    }

    // Turn a nodal vector (translation or slope) of one node back to the reference orientation.
    void turn_back(int station, int wire, double (&x)[3]) const {
        const Rotation& turn = rotation_[layout_.row(station)];
        const int g = B == 6 ? 0 : wire;
        const int lane = layout_.lane(station) + (B == 6 ? kLanes * wire : 0);
        const double back[3] = {-turn.w[g][0][lane], -turn.w[g][1][lane], -turn.w[g][2][lane]};
        rotate<double>(back, turn.scale[g][lane], x);
    }

    double scale = 1.0;  // of the solution, to make up for the factor of a longer time step

private:
    static constexpr int kGroups = B / 6;  // V holds both wires for B = 6
    struct Tangent {
        V t[kGroups][3];
    };
    struct Rotation {
        V w[kGroups][3], scale[kGroups];
    };
    // Droppers of a row as rank-one parts of the matrix, all segments at once. Droppers are too far
    // apart to feel each other within a time step.
    struct HangerColumn {
        RowColumn<V, B> column;
        V share;  // 1/(1/stiffness + compliance)
    };
    static constexpr bool kHasHangers = B == 6;

    void set_hangers(const Buffer<Row>& state, const Line& line, double over_step);

    struct Triple {
        V x[3];
    };

    static V one() { return broadcast<V>(1.0); }

    TAUTWIRE_INLINE static Triple group(
        int g, const Doubles* contact, const Doubles* messenger) {
        Triple out;
        for (int i = 0; i < 3; ++i) {
            if constexpr (B == 6) {
                out.x[i] = join(contact[i], messenger[i]);
            } else {
                out.x[i] = g == 0 ? contact[i] : messenger[i];
            }
        }
        return out;
    }

    TAUTWIRE_INLINE static void unit(const Triple& v, V (&t)[3]) {
        const V norm = square_root(v.x[0] * v.x[0] + v.x[1] * v.x[1] + v.x[2] * v.x[2]);
        const V inverse = one() / norm;
        for (int i = 0; i < 3; ++i) t[i] = v.x[i] * inverse;
    }

    Layout layout_;
    RowRange range_{0, -1};
    BlockChain<V, B> chain_;
    Buffer<Tangent> tangent_;
    Buffer<Rotation> rotation_;
    Buffer<HangerColumn> hangers_;
};

template <class V, int B>
void Preconditioner<V, B>::set_hangers(
    const Buffer<Row>& state, const Line& line, double over_step) {
    for (int row = 0; row < layout_.rows; ++row) {
        if (line.hanger_of[row] < 0) continue;
        const Hanger& hanger = line.hangers[line.hanger_of[row]];
        HangerColumn& out = hangers_[line.hanger_of[row]];
        const Doubles exists = is_positive(hanger.stiffness);
        Doubles t[3];
        for (int i = 0; i < 3; ++i) t[i] = state[row][1][i] - state[row][0][i];
        const Doubles inverse = exists / square_root(dot(t, t));
        V rhs[B];
        for (int i = 0; i < 3; ++i) {
            rhs[i] = join(-inverse * t[i], inverse * t[i]);
            rhs[3 + i] = broadcast<V>(0.0);
        }
        chain_.eliminate_row(row, rhs, out.column);
        const V own = out.column.response();
        const V stiffness = join(over_step * hanger.stiffness, over_step * hanger.stiffness);
        out.share = stiffness / (one() + stiffness * (own + other_wire(own)));
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
