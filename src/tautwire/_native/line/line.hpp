// The wires on lanes: what stays the same during a time integration.
//
// All force coefficients carry the factor 1 + alpha of the HHT method (1 for Newmark), so that the
// kernels need not know it.
#pragma once

#include "engine.hpp"
#include "line/element.hpp"
#include "line/layout.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Wire elements between a row and the next.
struct Element {
    Doubles length, inverse_length;
    Stiffness<Doubles> stiffness;
    Inertia<Doubles> inertia;

    static Element of(Doubles length, Doubles axial, Doubles bending, Doubles mass) {
        return {length, 1.0 / length, {0.5 * axial, 4.0 * bending / (length * length)},
                Inertia<Doubles>::of(mass * length, length)};
    }
};

// Which degrees of freedom of a row may move: 1, or 0 where one is held.
struct Hold {
    Row free;
};

class Line {
public:
    // Its rows in a number of parts; by default see Layout.
    Line(const LineData& data, double weight, int parts = 0);

    // Whether a time step asks for another bending stiffness of the wires; set it.
    bool depends_on(double dt) const { return bending_.size() > 0 && dt != time_step_; }
    void set_time_step(double dt);
    double time_step() const { return time_step_; }
    bool is_held(int node, int i) const {
        const Slot s = layout.slot(node);
        return hold_of[s.row] >= 0 && holds[hold_of[s.row]].free[s.half][i][s.lane] == 0.0;
    }

    // Whether a cable joins a node and the next.
    bool joined(int node) const {
        const Slot s = layout.slot(node);
        const Element& e = element[2 * s.row + s.half];
        return e.inertia.even[s.lane] != 0.0 || e.stiffness.half_axial[s.lane] != 0.0;
    }

    Layout layout;
    Buffer<Element> element;    // [2 row + half]: behind the nodes of a row
    Buffer<Doubles> node_mass;  // [2 row + half]
    Buffer<Row> position, load;
    Buffer<Hold> holds;
    Buffer<int> hold_of;  // per row: index into holds, or -1
    double damping_mass, damping_stiffness, weight;

private:
    // What does not depend on the time step, and what is added per square of it.
    struct Parts {
        Doubles constant, per_square;
    };

    void set_stiffening(const LineData& data);
    void set_elements(const LineData& data);
    void set_nodes(const LineData& data);
    void set_holds(const LineData& data);

    double time_step_ = 0.0;
    Buffer<Parts> bending_, load_;  // [2 row + half], [12 row + 6 half + i]; empty: not stiffened
};

inline Line::Line(const LineData& data, double weight_, int parts)
    : layout(data.nodes, parts),
      element(2 * static_cast<std::size_t>(layout.rows)),
      node_mass(2 * static_cast<std::size_t>(layout.rows)),
      position(layout.rows),
      load(layout.rows),
      hold_of(layout.rows),
      damping_mass(weight_ * data.damping_mass),
      damping_stiffness(data.damping_stiffness),
      weight(weight_) {
    set_elements(data);
    set_nodes(data);
    set_holds(data);
    if (data.stiffening_bending) set_stiffening(data);
}

inline void Line::set_stiffening(const LineData& data) {
    bending_ = Buffer<Parts>(element.size());
    load_ = Buffer<Parts>(12 * load.size());
    for (std::size_t k = 0; k < load_.size(); ++k) load_[k].constant = load[k / 12][k % 12 / 6][k % 6];
    for (int node = 0; node < data.nodes; ++node) {
        const Slot s = layout.slot(node);
        const int k = 2 * s.row + s.half;
        for (int i = 0; i < 6; ++i)
            load_[6 * k + i].per_square[s.lane] = weight * data.stiffening_load[6 * node + i];
        if (node + 1 == data.nodes) continue;
        const double factor = 4.0 * weight / (data.length[node] * data.length[node]);
        bending_[k].constant[s.lane] = factor * data.bending_stiffness[node];
        bending_[k].per_square[s.lane] = factor * data.stiffening_bending[node];
    }
}

inline void Line::set_time_step(double dt) {
    if (!depends_on(dt)) return;
    time_step_ = dt;
    for (std::size_t k = 0; k < element.size(); ++k)
        element[k].stiffness.bending = bending_[k].constant + dt * dt * bending_[k].per_square;
    for (std::size_t k = 0; k < load_.size(); ++k)
        load[k / 12][k % 12 / 6][k % 6] = load_[k].constant + dt * dt * load_[k].per_square;
}

inline void Line::set_elements(const LineData& data) {
    for (int k = 0; k < 2 * layout.rows; ++k) {
        Doubles length = broadcast<Doubles>(1.0), axial = broadcast<Doubles>(0.0);
        Doubles bending = axial, mass = axial;  // the rest is padding without mass and stiffness
        for (int lane = 0; lane < kLanes; ++lane) {
            const int node = layout.node(k / 2, k % 2, lane);
            if (node + 1 >= data.nodes) continue;
            length[lane] = data.length[node];
            axial[lane] = weight * data.axial_stiffness[node];
            bending[lane] = weight * data.bending_stiffness[node];
            mass[lane] = data.mass[node];
        }
        element[k] = Element::of(length, axial, bending, mass);
    }
}

inline void Line::set_nodes(const LineData& data) {
    for (int node = 0; node < layout.padded(); ++node) {
        const Slot s = layout.slot(node);
        const bool exists = node < data.nodes;
        const int beyond = exists ? 0 : node - data.nodes + 1, from = node - beyond;
        for (int i = 0; i < 6; ++i) {
            position[s.row][s.half][i][s.lane] = data.position[6 * from + i] + (i == 0 ? beyond : 0);
            load[s.row][s.half][i][s.lane] = exists ? weight * data.load[6 * node + i] : 0.0;
        }
        node_mass[2 * s.row + s.half][s.lane] = exists ? data.node_mass[node] : 0.0;
    }
}

inline void Line::set_holds(const LineData& data) {
    for (int& index : hold_of) index = -1;
    int count = 0;
    for (int k = 0; k < 6 * data.nodes; ++k) {
        if (!data.fixed[k]) continue;
        int& index = hold_of[layout.slot(k / 6).row];
        if (index < 0) index = count++;
    }
    holds = Buffer<Hold>(count);
    for (Hold& hold : holds)
        for (int i = 0; i < 12; ++i) hold.free[i / 6][i % 6] = broadcast<Doubles>(1.0);
    for (int k = 0; k < 6 * data.nodes; ++k) {
        if (!data.fixed[k]) continue;
        const Slot s = layout.slot(k / 6);
        holds[hold_of[s.row]].free[s.half][k % 6][s.lane] = 0.0;
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
