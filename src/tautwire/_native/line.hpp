// The line on lanes: what stays the same during a time integration.
//
// All force coefficients carry the factor 1 + alpha of the HHT method (1 for Newmark), so that the
// kernels need not know it.
#pragma once

#include "element.hpp"
#include "layout.hpp"

namespace tautwire::TAUTWIRE_ISA {

// Wire elements between a row and the next.
struct Element {
    Doubles length, inverse_length;
    Stiffness<Doubles> stiffness;
    Inertia<Doubles> inertia;

    static Element of(Doubles length, Doubles axial, Doubles bending, Doubles mass) {
        return {length, 1.0 / length, Stiffness<Doubles>::of(axial, 4.0 * bending / (length * length)),
                Inertia<Doubles>::of(mass * length, length)};
    }
};

// Droppers of a row; stiffness 0 where there is none.
struct Hanger {
    Doubles length, stiffness, damping;
};

// Steady arms, grounded springs and held degrees of freedom of a row.
struct Support {
    Doubles arm_end[3], arm_length, arm_stiffness;
    Doubles arm_damping[6];  // b_R K0, upper triangle
    Doubles spring_stiffness[2][6], spring_damping[2][6], spring_free[2][6];
    Doubles free[2][6];  // 0 where a degree of freedom is held, 1 elsewhere
};

// Coordinates, velocities or forces of the nodes of a row.
using Row = Doubles[2][6];

class Line {
public:
    Line(const LineData& data, double weight);

    // Whether a time step asks for another bending stiffness of the wires; set it.
    bool depends_on(double dt) const { return bending_.size() > 0 && dt != time_step_; }
    void set_time_step(double dt);
    double time_step() const { return time_step_; }

    Layout layout;
    Buffer<Element> element;    // [2 row + wire]
    Buffer<Doubles> node_mass;  // [2 row + wire]
    Buffer<Row> position, load;
    Buffer<Hanger> hangers;
    Buffer<Support> supports;
    Buffer<int> hanger_of, support_of;  // per row: index into the above, or -1
    double damping_mass, damping_stiffness, weight;
    int dropper_count;
    Buffer<int> dropper_row, dropper_lane;

private:
    // What does not depend on the time step, and what is added per square of it.
    struct Parts {
        Doubles constant, per_square;
    };

    void set_stiffening(const LineData& data);
    void set_elements(const LineData& data);
    void set_nodes(const LineData& data);
    void set_hangers(const LineData& data);
    void set_supports(const LineData& data);
    void set_arms(const LineData& data);

    double time_step_ = 0.0;
    Buffer<Parts> bending_, load_;  // [2 row + wire], [12 row + 6 wire + i]; empty: not stiffened
};

inline Line::Line(const LineData& data, double weight_)
    : layout(Layout::of(data)),
      element(2 * static_cast<std::size_t>(layout.rows)),
      node_mass(2 * static_cast<std::size_t>(layout.rows)),
      position(layout.rows),
      load(layout.rows),
      hanger_of(layout.rows),
      support_of(layout.rows),
      damping_mass(weight_ * data.damping_mass),
      damping_stiffness(data.damping_stiffness),
      weight(weight_),
      dropper_count(data.droppers),
      dropper_row(data.droppers),
      dropper_lane(data.droppers) {
    set_elements(data);
    set_nodes(data);
    set_hangers(data);
    set_supports(data);
    set_arms(data);
    if (data.stiffening_bending) set_stiffening(data);
}

inline void Line::set_stiffening(const LineData& data) {
    bending_ = Buffer<Parts>(element.size());
    load_ = Buffer<Parts>(12 * load.size());
    for (std::size_t k = 0; k < load_.size(); ++k) load_[k].constant = load[k / 12][k % 12 / 6][k % 6];
    const int count = data.stations - 1;
    for (int s = 0; s < data.stations; ++s) {
        const int row = layout.row(s), lane = layout.lane(s);
        for (int i = 0; i < 12; ++i)
            load_[12 * row + i].per_square[lane] = weight * data.stiffening_load[12 * s + i];
        if (s == count) continue;
        for (int wire = 0; wire < 2; ++wire) {
            const int i = wire * count + s;
            const double factor = 4.0 * weight / (data.length[i] * data.length[i]);
            bending_[2 * row + wire].constant[lane] = factor * data.bending_stiffness[i];
            bending_[2 * row + wire].per_square[lane] = factor * data.stiffening_bending[i];
        }
    }
}

inline void Line::set_time_step(double dt) {
    if (!depends_on(dt)) return;
    time_step_ = dt;
    for (std::size_t k = 0; k < element.size(); ++k)
        element[k].stiffness.set_bending(bending_[k].constant + dt * dt * bending_[k].per_square);
    for (std::size_t k = 0; k < load_.size(); ++k)
        load[k / 12][k % 12 / 6][k % 6] = load_[k].constant + dt * dt * load_[k].per_square;
}

inline void Line::set_elements(const LineData& data) {
    const int count = data.stations - 1;
    for (int row = 0; row < layout.rows; ++row)
        for (int wire = 0; wire < 2; ++wire) {
            Doubles length = broadcast<Doubles>(1.0), axial = broadcast<Doubles>(0.0);
            Doubles bending = axial, mass = axial;  // the rest is padding without mass and stiffness
            for (int lane = 0; lane < kLanes; ++lane) {
                const int s = lane * layout.rows + row, i = wire * count + s;
                if (s >= count) continue;
                length[lane] = data.length[i];
                axial[lane] = weight * data.axial_stiffness[i];
                bending[lane] = weight * data.bending_stiffness[i];
                mass[lane] = data.mass[i];
            }
            element[2 * row + wire] = Element::of(length, axial, bending, mass);
        }
}

inline void Line::set_nodes(const LineData& data) {
    for (int s = 0; s < layout.rows * kLanes; ++s) {
        const int row = layout.row(s), lane = layout.lane(s);
        const bool exists = s < data.stations;
        const int beyond = exists ? 0 : s - data.stations + 1, from = s - beyond;
        for (int wire = 0; wire < 2; ++wire) {
            for (int i = 0; i < 6; ++i) {
                const int dof = (2 * from + wire) * 6 + i;
                position[row][wire][i][lane] = data.position[dof] + (i == 0 ? beyond : 0);
                load[row][wire][i][lane] = exists ? weight * data.load[dof] : 0.0;
            }
            node_mass[2 * row + wire][lane] = exists ? data.node_mass[2 * s + wire] : 0.0;
        }
    }
}

// Number the rows that are marked; -1 for the others.
inline int number_rows(const Buffer<bool>& marked, Buffer<int>& index) {
    int count = 0;
    for (std::size_t k = 0; k < marked.size(); ++k) index[k] = marked[k] ? count++ : -1;
    return count;
}

inline void Line::set_hangers(const LineData& data) {
    Buffer<bool> marked(layout.rows);
    for (int i = 0; i < data.droppers; ++i) {
        dropper_row[i] = layout.row(static_cast<int>(data.dropper_station[i]));
        dropper_lane[i] = layout.lane(static_cast<int>(data.dropper_station[i]));
        marked[dropper_row[i]] = true;
    }
    hangers = Buffer<Hanger>(number_rows(marked, hanger_of));
    for (int i = 0; i < data.droppers; ++i) {
        Hanger& hanger = hangers[hanger_of[dropper_row[i]]];
        const int lane = dropper_lane[i];
        const double stiffness = weight * data.dropper_stiffness[i];
        hanger.length[lane] = data.dropper_length[i];
        hanger.stiffness[lane] = stiffness;
        hanger.damping[lane] = data.damping_stiffness * stiffness;
    }
}

inline void Line::set_supports(const LineData& data) {
    Buffer<bool> marked(layout.rows);
    for (int i = 0; i < data.arms; ++i) marked[layout.row(static_cast<int>(data.arm_station[i]))] = true;
    for (int i = 0; i < data.springs; ++i)
        marked[layout.row(static_cast<int>(data.spring_dof[i] / 12))] = true;
    for (int dof = 0; dof < 12 * data.stations; ++dof)
        if (data.fixed[dof]) marked[layout.row(dof / 12)] = true;
    supports = Buffer<Support>(number_rows(marked, support_of));
    for (int k = 0; k < layout.rows; ++k) {
        if (support_of[k] < 0) continue;
        Support& support = supports[support_of[k]];
        support.arm_length = broadcast<Doubles>(1.0);
        for (int i = 0; i < 3; ++i) support.arm_end[i] = position[k][0][i];
        support.arm_end[2] = support.arm_end[2] - 1.0;  // where there is none, a bar without force
        for (int wire = 0; wire < 2; ++wire)
            for (int i = 0; i < 6; ++i) support.free[wire][i] = broadcast<Doubles>(1.0);
    }
    for (int dof = 0; dof < 12 * data.stations; ++dof)
        if (data.fixed[dof])
            supports[support_of[layout.row(dof / 12)]].free[dof % 12 / 6][dof % 6][layout.lane(dof / 12)] = 0.0;
    for (int i = 0; i < data.springs; ++i) {
        const int dof = static_cast<int>(data.spring_dof[i]), lane = layout.lane(dof / 12);
        Support& support = supports[support_of[layout.row(dof / 12)]];
        const double before = support.spring_stiffness[dof % 12 / 6][dof % 6][lane];
        const double added = weight * data.spring_stiffness[i];
        double free = data.spring_free[i];
        if (before + added != 0.0)  // two springs on one degree of freedom act like one
            free = (before * support.spring_free[dof % 12 / 6][dof % 6][lane] + added * free) / (before + added);
        support.spring_stiffness[dof % 12 / 6][dof % 6][lane] = before + added;
        support.spring_damping[dof % 12 / 6][dof % 6][lane] += weight * data.spring_damping[i];
        support.spring_free[dof % 12 / 6][dof % 6][lane] = free;
    }
}

inline void Line::set_arms(const LineData& data) {
    for (int n = 0; n < data.arms; ++n) {
        const int station = static_cast<int>(data.arm_station[n]);
        const int row = layout.row(station), lane = layout.lane(station);
        Support& support = supports[support_of[row]];
        double t[3], length = 0.0;
        for (int i = 0; i < 3; ++i) {
            const double end = data.arm_end[3 * n + i];
            t[i] = position[row][0][i][lane] - end;
            support.arm_end[i][lane] = end;
            length += t[i] * t[i];
        }
        length = std::sqrt(length);
        const double stiffness = weight * data.arm_stiffness[n];
        support.arm_length[lane] = data.arm_length[n];
        support.arm_stiffness[lane] = stiffness;
        const double geometric = stiffness * (length - data.arm_length[n]) / length;
        for (int i = 0, k = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j, ++k)
                support.arm_damping[k][lane] =
                    data.damping_stiffness * ((stiffness - geometric) * t[i] * t[j] / (length * length) +
                                              (i == j ? geometric : 0.0));
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
