// The matrix of a reference state, turned node by node with the wires: x = R A^-1 R' r.
//
// The stiffest part of a wire, its axial stiffness, turns with the wire. A constant matrix is a poor
// approximation of the tangent after small rotations; turned with the nodes it stays a good one.
#pragma once

#include "chain/couplings.hpp"

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

class Preconditioner {
public:
    // Whether the residual's bending forces may be formed in single precision; see elastic_forces.
    static constexpr bool kSingleBending = true;

    Preconditioner(const Line& line, const Attachments& attached, const Buffer<int>& rank)
        : line_(line), attached_(attached), rank_(rank), chain_(line.layout),
          couplings_(line, attached), tangent_(line.layout.rows), rotation_(line.layout.rows) {}

    // Factor the matrix at a state; false when it is not positive definite.
    bool factor(const Factors& factors, const Buffer<Row>& state) {
        for (int row = 0; row < line_.layout.rows; ++row) {
            unit(state[row], tangent_[row].t);
            for (Floats& component : rotation_[row].w) component = broadcast<Floats>(0.0);
            rotation_[row].scale = broadcast<Floats>(0.5);
        }
        Buffer<NodeBlocks> blocks(line_.layout.nodes);
        Assembly(line_, attached_).sum_chain(factors, state, blocks);
        return chain_.factor(blocks) && couplings_.set(chain_, factors, state, rank_);
    }

    // Set the rotation of a row from the reference tangents to those of the present slopes.
    TAUTWIRE_INLINE void set_rotation(int row, const Row& q) {
        Floats t[3];
        unit(q, t);
        const Floats(&t0)[3] = tangent_[row].t;
        Floats(&w)[3] = rotation_[row].w;
        w[0] = t0[1] * t[2] - t0[2] * t[1];
        w[1] = t0[2] * t[0] - t0[0] * t[2];
        w[2] = t0[0] * t[1] - t0[1] * t[0];
        const Floats cosine = t0[0] * t[0] + t0[1] * t[1] + t0[2] * t[2];
        rotation_[row].scale = one() / (one() + cosine);
    }

    void clear_contacts() { couplings_.clear_contacts(); }
    void add_contact(int node, const double (&rhs)[2][6], double kappa) {
        couplings_.add_contact(chain_, node, rhs, kappa);
    }
    int contacts() const { return couplings_.contacts(); }

    // Turn a vector of a node back to the orientation of the reference state.
    void turn_back(int node, double (&x)[3]) const {
        const Slot s = line_.layout.slot(node);
        const Rotation& turn = rotation_[s.row];
        const int p = s.piece();
        const double back[3] = {-turn.w[0][p], -turn.w[1][p], -turn.w[2][p]};
        rotate<double>(back, turn.scale[p], x);
    }

    // Forward sweep; see Chain. A row `starts` a run when it is its first.
    TAUTWIRE_INLINE void eliminate(int row, bool starts, const Row& r) {
        Floats x[6];
        for (int i = 0; i < 6; ++i) x[i] = join(r[0][i], r[1][i]);
        const Rotation& turn = rotation_[row];
        const Floats back[3] = {-turn.w[0], -turn.w[1], -turn.w[2]};
        rotate(back, turn.scale, x);
        rotate(back, turn.scale, x + 3);
        chain_.eliminate(row, starts, x);
    }
    // Eliminate a row whose right-hand side is zero.
    TAUTWIRE_INLINE void pass(int row, bool starts) {
        Floats x[6];
        for (Floats& value : x) value = broadcast<Floats>(0.0);
        chain_.eliminate(row, starts, x);
    }
    void end_run(int part, const Run& run) { chain_.end_run(part, run); }
    // To be called for all parts when all of them are eliminated; side by side if that is local.
    bool is_local() const { return chain_.is_local(); }
    void finish_elimination(const RowSet& set, int part) {
        chain_.finish_elimination(set, part);
    }
    // Correct for the couplings that act: project all parts, solve, then apply to all parts; see
    // Couplings.
    void project(const RowSet& set, int part) { couplings_.project(chain_, set, part); }
    bool solve_couplings(const bool* closed, const double* compliance) {
        return couplings_.solve(closed, compliance);
    }
    void apply_couplings(const RowSet& set, int part) { couplings_.apply(chain_, set, part); }

    // Backward sweep; see Chain.
    using Local = Chain::Block;
    void begin_substitution(const RowSet& set, const Run& run, Local& local) const {
        chain_.begin_substitution(set, run, local);
    }
    // Solve for a row, from the last of a run to the first; `size` is the largest |x| of translations
    // lane by lane, and `total` collects them to find values that are not finite.
    TAUTWIRE_INLINE void substitute(int row, Local& local, Row& out, Floats& size, Floats& total) const {
        chain_.substitute(row, local);
        Floats x[6];
        for (int i = 0; i < 6; ++i) x[i] = local[i];
        const Rotation& turn = rotation_[row];
        if (scale != 1.0)
            for (Floats& component : x) component *= broadcast<Floats>(scale);
        rotate(turn.w, turn.scale, x);
        rotate(turn.w, turn.scale, x + 3);
        for (int i = 0; i < 3; ++i) {
            const Floats part = absolute(x[i]);
            size = i == 0 ? part : maximum(size, part);
            total += part;
        }
        for (int i = 0; i < 12; ++i) out[i / 6][i % 6] = widen(x[i % 6], i / 6);
    }

    double scale = 1.0;  // of the solution, to make up for the factor of a longer time step

private:
    struct Tangent {
        Floats t[3];
    };
    struct Rotation {
        Floats w[3], scale;
    };

    static Floats one() { return broadcast<Floats>(1.0); }

    TAUTWIRE_INLINE static void unit(const Row& q, Floats (&t)[3]) {
        for (int i = 0; i < 3; ++i) t[i] = join(q[0][3 + i], q[1][3 + i]);
        const Floats norm = square_root(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
        const Floats inverse = one() / norm;
        for (Floats& component : t) component *= inverse;
    }

    const Line& line_;
    const Attachments& attached_;
    const Buffer<int>& rank_;
    Chain chain_;
    Couplings couplings_;
    Buffer<Tangent> tangent_;
    Buffer<Rotation> rotation_;
};

}  // namespace tautwire::TAUTWIRE_ISA
