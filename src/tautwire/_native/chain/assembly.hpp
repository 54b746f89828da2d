// The effective matrix M + c C + k K at given states of the line.
#pragma once

#include "chain/blocks.hpp"
#include "line/attachments.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Coordinates (r1, r1', r2, r2') of the elements behind `row` of one half.
inline void element_nodes(const Line& line, const Buffer<Row>& state, int row, int half,
                          Doubles (&left)[6], Doubles (&right)[6]) {
    const bool last = row + 1 == line.layout.rows;
    for (int i = 0; i < 6; ++i) {
        left[i] = state[row][half][i];
        const int behind = last ? 0 : row + 1;
        Doubles both[2] = {state[behind][0][i], state[behind][1][i]};
        if (last) to_previous_piece(both);
        right[i] = both[half];
    }
    if (!last || half == 0) return;
    for (int i = 0; i < 6; ++i)  // behind the last piece there is padding: any regular element
        right[i][kLanes - 1] = i % 3 == 0 ? left[i][kLanes - 1] + (i == 0) : left[i][kLanes - 1];
}

// Expand a packed tangent to nodal coordinates (r1, r1', r2, r2').
inline void nodal_tangent(const Doubles (&packed_tangent)[kPacked], const Element& element,
                          Doubles (&out)[12][12]) {
    const Doubles zero = broadcast<Doubles>(0.0), d = 1.5 * element.inverse_length;
    const auto number = [](double value) { return broadcast<Doubles>(value); };
    // What the nodal vectors contribute to the coefficients of the parabola.
    const Doubles map[4][3] = {{-d, zero, d},
                               {number(-0.25), number(-0.5), number(0.75)},
                               {d, zero, -d},
                               {number(-0.25), number(0.5), number(0.75)}};
    for (int row = 0; row < 12; ++row)
        for (int column = row; column < 12; ++column) {
            Doubles entry = zero;
            for (int m = 0; m < 3; ++m)
                for (int n = 0; n < 3; ++n)
                    entry += map[row / 3][m] * map[column / 3][n] *
                             packed_tangent[packed(3 * m + row % 3, 3 * n + column % 3)];
            out[row][column] = out[column][row] = entry * element.length;
        }
}

struct Factors {
    double mass, damping, stiffness;  // of M, C and K
};

class Assembly {
public:
    Assembly(const Line& line, const Attachments& attached) : line_(line), attached_(attached) {}

    // Sum the blocks of the wires with what holds them to the ground, for the tangent at `state` and
    // K0 at the static state. Rows and columns of held degrees of freedom become the identity.
    void sum_chain(const Factors& factors, const Buffer<Row>& state, Buffer<NodeBlocks>& out) const {
        std::memset(static_cast<void*>(out.data()), 0, out.size() * sizeof(NodeBlocks));
        for (int row = 0; row < line_.layout.rows; ++row)
            for (int half = 0; half < 2; ++half) add_elements(row, half, factors, state, out);
        for (const auto& stay : attached_.stays)
            if (stay.law == Law::both_ways) add_stay(stay, factors.stiffness, state, out);
        for (const auto& ground : attached_.grounds)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    out[ground.node].diagonal[i][j] += factors.stiffness * ground.stiffness[i][j] +
                                                       factors.damping * ground.damping[i][j];
        for (int node = 0; node < line_.layout.nodes; ++node) hold(node, out);
    }

    // Call add(a, b, block) for everything that joins nodes and acts in a state with velocities: the
    // matrix has the block at both nodes, and minus the block between them. b is -1 for the ground.
    template <class F>
    void visit_couplings(const Factors& factors, const Buffer<Row>& state,
                         const Buffer<Row>& velocity, F add) const {
        const double of_ties = factors.stiffness + factors.damping * line_.damping_stiffness;
        double w[3], v[3], block[3][3];
        for (const auto& tie : attached_.ties) {
            const double length = between(state, tie.upper, tie.lower, w);
            between(velocity, tie.upper, tie.lower, v);
            const double rate = (w[0] * v[0] + w[1] * v[1] + w[2] * v[2]) / length;
            if (!acts(tie.law, length - tie.length + line_.damping_stiffness * rate)) continue;
            bar_stiffness(w, of_ties * tie.stiffness, tie.length, block);
            add(tie.upper, tie.lower, block);
        }
        for (const auto& clamp : attached_.clamps) {
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    block[i][j] = i == j ? factors.stiffness * clamp.stiffness : 0.0;
            add(clamp.host, clamp.other, block);
        }
        for (const auto& stay : attached_.stays) {
            const double length = reach(stay, state, w);
            if (stay.law == Law::both_ways || !acts(stay.law, length - stay.length)) continue;
            bar_stiffness(w, factors.stiffness * stay.stiffness, stay.length, block);
            add(stay.node, -1, block);
        }
    }

private:
    void add_elements(int row, int half, const Factors& factors, const Buffer<Row>& state,
                      Buffer<NodeBlocks>& out) const {
        const Layout& layout = line_.layout;
        const Element& element = line_.element[2 * row + half];
        Doubles left[6], right[6], tangent[kPacked], part[kPacked];
        element_nodes(line_, state, row, half, left, right);
        elastic_tangent(parabola(left, right, element.inverse_length), element.stiffness, tangent);
        element_nodes(line_, line_.position, row, half, left, right);
        elastic_tangent(parabola(left, right, element.inverse_length), element.stiffness, part);
        const double c = factors.damping * line_.damping_stiffness;
        for (int i = 0; i < kPacked; ++i) tangent[i] = factors.stiffness * tangent[i] + c * part[i];
        Doubles k[12][12];
        nodal_tangent(tangent, element, k);
        const double of_mass = factors.mass + factors.damping * line_.damping_mass;
        add_mass(element, of_mass, k);
        for (int lane = 0; lane < kLanes; ++lane) {
            const int node = layout.node(row, half, lane);
            if (node >= layout.nodes) continue;
            for (int i = 0; i < 3; ++i)
                out[node].diagonal[i][i] += of_mass * line_.node_mass[2 * row + half][lane];
            if (node + 1 == layout.nodes) continue;
            for (int i = 0; i < 6; ++i)
                for (int j = 0; j < 6; ++j) {
                    out[node].diagonal[i][j] += k[i][j][lane];
                    out[node].next[i][j] += k[i][6 + j][lane];
                    out[node + 1].diagonal[i][j] += k[6 + i][6 + j][lane];
                }
        }
    }

    // Add the consistent mass to the rows and columns of (r1, r1', r2, r2').
    static void add_mass(const Element& element, double factor, Doubles (&k)[12][12]) {
        const Inertia<Doubles>& m = element.inertia;
        const Doubles nodes[2] = {m.even + m.odd, m.even - m.odd};  // same end, other end
        const Doubles cross[2] = {m.even_cross + m.odd_cross, m.even_cross - m.odd_cross};
        const Doubles slopes[2] = {m.odd_slope + m.even_slope, m.odd_slope - m.even_slope};
        for (int end = 0; end < 2; ++end)
            for (int other = 0; other < 2; ++other)
                for (int i = 0; i < 3; ++i) {
                    const int r = 6 * end + i, r2 = 6 * other + i, apart = end != other;
                    // A slope at the left end pushes both nodes forward, at the right end back.
                    const double sign = other == 0 ? 1.0 : -1.0;
                    k[r][r2] += factor * nodes[apart];
                    k[r + 3][r2 + 3] += factor * slopes[apart];
                    k[r][r2 + 3] += factor * sign * cross[apart];
                    k[r2 + 3][r] += factor * sign * cross[apart];
                }
    }

    // The vector from the end of a stay to its node, and its length.
    double reach(const Attachments::Stay& stay, const Buffer<Row>& state, double (&w)[3]) const {
        for (int i = 0; i < 3; ++i) w[i] = value(state, line_.layout, stay.node, i) - stay.end[i];
        return std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    }
    // The vector from node b to node a, and its length.
    double between(const Buffer<Row>& state, int a, int b, double (&w)[3]) const {
        for (int i = 0; i < 3; ++i)
            w[i] = value(state, line_.layout, a, i) - value(state, line_.layout, b, i);
        return std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    }

    void add_stay(const Attachments::Stay& stay, double factor, const Buffer<Row>& state,
                  Buffer<NodeBlocks>& out) const {
        double w[3], block[3][3];
        reach(stay, state, w);
        bar_stiffness(w, factor * stay.stiffness, stay.length, block);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) out[stay.node].diagonal[i][j] += block[i][j];
    }

    // Replace the rows and columns of held degrees of freedom by the identity.
    void hold(int node, Buffer<NodeBlocks>& out) const {
        for (int i = 0; i < 6; ++i) {
            if (!line_.is_held(node, i)) continue;
            for (int j = 0; j < 6; ++j)
                out[node].diagonal[i][j] = out[node].diagonal[j][i] = i == j ? 1.0 : 0.0;
            for (int j = 0; j < 6; ++j) {
                out[node].next[i][j] = 0.0;
                if (node > 0) out[node - 1].next[j][i] = 0.0;
            }
        }
    }

    const Line& line_;
    const Attachments& attached_;
};

}  // namespace tautwire::TAUTWIRE_ISA
