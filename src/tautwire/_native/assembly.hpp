// Station blocks of the effective matrix M + c C + k K at given states of the line.
#pragma once

#include "blocks.hpp"
#include "line.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Coordinates (r1, r1', r2, r2') of the elements behind `row` of one wire.
inline void element_nodes(const Line& line, const Buffer<Row>& state, int row, int wire,
                          Doubles (&left)[6], Doubles (&right)[6]) {
    const bool last = row + 1 == line.layout.rows;
    for (int i = 0; i < 6; ++i) {
        left[i] = state[row][wire][i];
        right[i] = last ? to_previous_segment(state[0][wire][i]) : state[row + 1][wire][i];
    }
    if (!last) return;
    for (int i = 0; i < 6; ++i)  // behind the last lane there is padding: any regular element
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
    Assembly(const Line& line, Buffer<StationBlocks>& blocks) : line_(line), blocks_(blocks) {}

    // Sum the blocks for the tangent at `state` and K0 at the static state; with `velocity`, droppers
    // that carry force at that velocity take part, without it none do.
    void sum(const Factors& factors, const Buffer<Row>& state, const Buffer<Row>* velocity) {
        std::memset(static_cast<void*>(blocks_.data()), 0, blocks_.size() * sizeof(StationBlocks));
        for (int row = 0; row < line_.layout.rows; ++row) {
            for (int wire = 0; wire < 2; ++wire) add_elements(row, wire, factors, state);
            if (line_.hanger_of[row] >= 0 && velocity) add_hangers(row, factors, state, *velocity);
            if (line_.support_of[row] >= 0) add_supports(row, factors, state);
        }
        for (int row = 0; row < line_.layout.rows; ++row)
            if (line_.support_of[row] >= 0) hold(row);
    }

private:
    int station(int row, int lane) const { return lane * line_.layout.rows + row; }

    void add_elements(int row, int wire, const Factors& factors, const Buffer<Row>& state) {
        const Element& element = line_.element[2 * row + wire];
        Doubles left[6], right[6], tangent[kPacked], part[kPacked];
        element_nodes(line_, state, row, wire, left, right);
        elastic_tangent(parabola(left, right, element.inverse_length), element.stiffness, tangent);
        element_nodes(line_, line_.position, row, wire, left, right);
        elastic_tangent(parabola(left, right, element.inverse_length), element.stiffness, part);
        const double c = factors.damping * line_.damping_stiffness;
        for (int i = 0; i < kPacked; ++i) tangent[i] = factors.stiffness * tangent[i] + c * part[i];
        Doubles k[12][12];
        nodal_tangent(tangent, element, k);
        add_mass(element, mass_factor(factors), k);
        for (int lane = 0; lane < kLanes; ++lane) {
            const int s = station(row, lane);
            if (s + 1 >= line_.layout.stations) continue;
            for (int i = 0; i < 6; ++i)
                for (int j = 0; j < 6; ++j) {
                    blocks_[s].diagonal[6 * wire + i][6 * wire + j] += k[i][j][lane];
                    blocks_[s].next[wire][i][j] += k[i][6 + j][lane];
                    blocks_[s + 1].diagonal[6 * wire + i][6 * wire + j] += k[6 + i][6 + j][lane];
                }
        }
        for (int lane = 0; lane < kLanes; ++lane) {
            if (station(row, lane) >= line_.layout.stations) continue;
            for (int i = 0; i < 3; ++i)
                blocks_[station(row, lane)].diagonal[6 * wire + i][6 * wire + i] +=
                    mass_factor(factors) * line_.node_mass[2 * row + wire][lane];
        }
    }

    double mass_factor(const Factors& factors) const {
        return factors.mass + factors.damping * line_.damping_mass;
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

    // Add k t t' + N/l (1 - t t') for a bar along `w`, the vector between its ends.
    static void add_bar(double (&block)[3][3], const double (&w)[3], double stiffness, double free) {
        const double length = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        const double geometric = stiffness * (length - free) / length;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                block[i][j] += (stiffness - geometric) * w[i] * w[j] / (length * length) +
                               (i == j ? geometric : 0.0);
    }

    void add_hangers(int row, const Factors& factors, const Buffer<Row>& state,
                     const Buffer<Row>& velocity) {
        const Hanger& hanger = line_.hangers[line_.hanger_of[row]];
        const double factor = factors.stiffness + factors.damping * line_.damping_stiffness;
        for (int lane = 0; lane < kLanes; ++lane) {
            if (hanger.stiffness[lane] == 0.0) continue;
            double w[3], block[3][3] = {}, length = 0.0, rate = 0.0;  // rate: length times speed
            for (int i = 0; i < 3; ++i) {
                w[i] = state[row][1][i][lane] - state[row][0][i][lane];
                length += w[i] * w[i];
                rate += w[i] * (velocity[row][1][i][lane] - velocity[row][0][i][lane]);
            }
            length = std::sqrt(length);
            const double force = hanger.stiffness[lane] * (length - hanger.length[lane]) +
                                 hanger.damping[lane] * rate / length;
            if (!(force > 0.0)) continue;
            add_bar(block, w, factor * hanger.stiffness[lane], hanger.length[lane]);
            StationBlocks& here = blocks_[station(row, lane)];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    here.diagonal[i][j] += block[i][j];
                    here.diagonal[6 + i][6 + j] += block[i][j];
                    here.diagonal[i][6 + j] -= block[i][j];
                    here.diagonal[6 + i][j] -= block[i][j];
                }
        }
    }

    void add_supports(int row, const Factors& factors, const Buffer<Row>& state) {
        const Support& support = line_.supports[line_.support_of[row]];
        for (int lane = 0; lane < kLanes; ++lane) {
            if (station(row, lane) >= line_.layout.stations) continue;
            StationBlocks& here = blocks_[station(row, lane)];
            double w[3], block[3][3] = {};
            for (int i = 0; i < 3; ++i) w[i] = state[row][0][i][lane] - support.arm_end[i][lane];
            add_bar(block, w, factors.stiffness * support.arm_stiffness[lane], support.arm_length[lane]);
            for (int i = 0, k = 0; i < 3; ++i)
                for (int j = i; j < 3; ++j, ++k) {
                    const double entry = block[i][j] + factors.damping * support.arm_damping[k][lane];
                    here.diagonal[i][j] += entry;
                    if (j > i) here.diagonal[j][i] += entry;
                }
            for (int i = 0; i < 12; ++i)
                here.diagonal[i][i] +=
                    factors.stiffness * support.spring_stiffness[i / 6][i % 6][lane] +
                    factors.damping * support.spring_damping[i / 6][i % 6][lane];
        }
    }

    // Replace the rows and columns of held degrees of freedom by the identity.
    void hold(int row) {
        const Support& support = line_.supports[line_.support_of[row]];
        for (int lane = 0; lane < kLanes; ++lane)
            for (int i = 0; i < 12; ++i) {
                if (support.free[i / 6][i % 6][lane] != 0.0) continue;
                const int s = station(row, lane);
                for (int j = 0; j < 12; ++j)
                    blocks_[s].diagonal[i][j] = blocks_[s].diagonal[j][i] = i == j ? 1.0 : 0.0;
                for (int j = 0; j < 6; ++j) {
                    blocks_[s].next[i / 6][i % 6][j] = 0.0;
                    if (s > 0) blocks_[s - 1].next[i / 6][j][i % 6] = 0.0;
                }
            }
    }

    const Line& line_;
    Buffer<StationBlocks>& blocks_;
};

}  // namespace tautwire::TAUTWIRE_ISA
