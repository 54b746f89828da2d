// What joins wires and holds them: ties, clamps, stays and grounds, on any node of any wire.
//
// Each kind is a list, evaluated one register at a time: the motion of the nodes is gathered, the
// forces are added to nodal forces, node by node in the order of the list.
#pragma once

#include <limits>

#include "line/line.hpp"

namespace tautwire::TAUTWIRE_ISA {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Coordinates q = q_p + q_of_v v_p + q_of_a a and velocities v = v_p + v_of_a a of the nodes.
struct MotionView {
    const Buffer<Row>&q_p, &v_p, &a;
    double q_of_v, q_of_a, v_of_a;
};

// Nodes of a list in registers; the last register repeats the last node.
class NodeList {
public:
    NodeList(const Layout& layout, int count, const std::int64_t* nodes, int stride)
        : count_(count), at_(static_cast<std::size_t>(count ? registers(count) * kLanes : 0)) {
        for (std::size_t n = 0; n < at_.size(); ++n) {
            const int last = static_cast<int>(n) < count ? static_cast<int>(n) : count - 1;
            at_[n] = layout.in_doubles(static_cast<int>(nodes[last * stride]));
        }
    }

    static int registers(int count) { return (count + kLanes - 1) / kLanes; }
    int registers() const { return registers(count_); }
    // Entries of a register that are not repeated.
    int filled(int k) const { return count_ - k * kLanes < kLanes ? count_ - k * kLanes : kLanes; }
    const int* at(int k) const { return &at_[k * kLanes]; }
    bool meets(const RowSet& set, int k) const {
        if (set.whole) return true;
        bool any = false;
        for (int lane = 0; lane < kLanes; ++lane) any |= set.formed[at(k)[lane] / (12 * kLanes)];
        return any;
    }

    // Gather position (velocity) of the nodes of a register.
    TAUTWIRE_INLINE void move(const MotionView& view, int k, Doubles (&q)[3], Doubles (&v)[3]) const {
        const auto* from_q = reinterpret_cast<const double*>(view.q_p.data());
        const auto* from_v = reinterpret_cast<const double*>(view.v_p.data());
        const auto* from_a = reinterpret_cast<const double*>(view.a.data());
        const int* at = &at_[k * kLanes];
        for (int i = 0; i < 3; ++i) {
            Doubles a;
            for (int lane = 0; lane < kLanes; ++lane) {
                const int place = at[lane] + i * kLanes;
                q[i][lane] = from_q[place];
                v[i][lane] = from_v[place];
                a[lane] = from_a[place];
            }
            q[i] += view.q_of_v * v[i] + view.q_of_a * a;
            v[i] += view.v_of_a * a;
        }
    }

private:
    int count_;
    Buffer<int> at_;
};

// Axial force of bars: stiffness (l - length) + damping dl/dt, as far as their law lets it act.
struct Bars {
    Buffer<Doubles> length, stiffness, damping, least, most;  // [register]
    Buffer<unsigned char> acting;  // which carried force at the last evaluation; always, if linear

    Bars(int count, const double* length_, const double* stiffness_, const std::int64_t* law,
         double weight, double damping_per_stiffness)
        : length(NodeList::registers(count)), stiffness(length.size()), damping(length.size()),
          least(length.size()), most(length.size()), acting(length.size() * kLanes) {
        for (Doubles& x : length) x = broadcast<Doubles>(1.0);
        for (int n = 0; n < count; ++n) {
            const int k = n / kLanes, lane = n % kLanes;
            const Law kind = static_cast<Law>(law[n]);
            length[k][lane] = length_[n];
            stiffness[k][lane] = weight * stiffness_[n];
            damping[k][lane] = damping_per_stiffness * stiffness[k][lane];
            least[k][lane] = kind == Law::tension_only ? 0.0 : -kInfinity;
            most[k][lane] = kind == Law::compression_only ? 0.0 : kInfinity;
        }
    }

    // Force per length along t, the vector between the ends, whose rate of change is given.
    TAUTWIRE_INLINE Doubles tension(int k, const Doubles (&t)[3], const Doubles (&rate)[3]) const {
        const Doubles l = square_root(dot(t, t)), inverse = 1.0 / l;
        const Doubles axial = stiffness[k] * (l - length[k]) + damping[k] * (inverse * dot(t, rate));
        return inverse * maximum(least[k], minimum(most[k], axial));
    }
    void note(int k, const Doubles& tension_) {
        for (int lane = 0; lane < kLanes; ++lane)
            acting[k * kLanes + lane] =
                tension_[lane] != 0.0 || (least[k][lane] < 0.0 && most[k][lane] > 0.0);
    }
};

// Whether a bar whose force would be that of a linear one (or has its sign) carries it.
inline bool acts(Law law, double force) {
    return law == Law::both_ways || (law == Law::tension_only ? force > 0.0 : force < 0.0);
}

// Tangent of a bar with the vector w between its ends: k t t' + N/l (1 - t t').
inline void bar_stiffness(const double (&w)[3], double stiffness, double free, double (&out)[3][3]) {
    const double length = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const double geometric = stiffness * (length - free) / length;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[i][j] = (stiffness - geometric) * w[i] * w[j] / (length * length) +
                        (i == j ? geometric : 0.0);
}

class Attachments {
public:
    Attachments(const LineData& data, const Line& line);

    // Add the forces to those on the nodes, of everything that has an end in the formed
    // rows; release takes them away again, exactly.
    void push(const MotionView& view, Buffer<Row>& force, const RowSet& set);
    void release(Buffer<Row>& force);

    // Axial forces of the ties.
    void tie_forces(const MotionView& view, double* out) const;

    // Which ties and stays carried force at the last push (1 or 0); the linear ones always.
    const Buffer<unsigned char>& acting_ties() const { return ties_.acting; }
    const Buffer<unsigned char>& acting_stays() const { return stays_.acting; }

    // What matrices need.
    struct Tie {
        int upper, lower;
        double length, stiffness;
        Law law;
    };
    struct Clamp {
        int host, other;
        double stiffness;
    };
    struct Stay {
        int node;
        double end[3], length, stiffness;
        Law law;
    };
    struct Ground {
        int node;
        double stiffness[3][3], damping[3][3], free[3];
    };
    Buffer<Tie> ties;
    Buffer<Clamp> clamps;
    Buffer<Stay> stays;
    Buffer<Ground> grounds;  // those of the line, then the damping of the stays

private:
    static Buffer<Tie> ties_of(const LineData& data, double weight);
    static Buffer<Clamp> clamps_of(const LineData& data, double weight);
    static Buffer<Stay> stays_of(const LineData& data, double weight);
    static Buffer<Ground> grounds_of(const LineData& data, const Buffer<Stay>& stays, double weight);
    template <class T>
    static Buffer<std::int64_t> nodes_of(const Buffer<T>& parts);
    void pack();

    TAUTWIRE_INLINE void add(const NodeList& nodes, int k, const Doubles (&f)[3], double sign);
    void push_ties(const MotionView& view, const RowSet& set);
    void push_clamps(const MotionView& view, const RowSet& set);
    void push_stays(const MotionView& view, const RowSet& set);
    void push_grounds(const MotionView& view, const RowSet& set);

    const Layout& layout_;
    double weight_;
    NodeList upper_, lower_, host_, other_, stayed_, grounded_;
    Bars ties_, stays_;
    // [register][component]
    Buffer<Doubles> clamp_stiffness_, clamp_offset_, stay_end_, ground_stiffness_, ground_damping_,
        ground_free_;
    // Forces as they were, in the order in which they were changed.
    struct Kept {
        int at;
        double force;
    };
    Buffer<Kept> kept_;
    int kept_count_ = 0;
    double* force_ = nullptr;
};

inline Buffer<Attachments::Tie> Attachments::ties_of(const LineData& data, double weight) {
    Buffer<Tie> out(data.ties);
    for (int n = 0; n < data.ties; ++n)
        out[n] = {static_cast<int>(data.tie_nodes[2 * n]), static_cast<int>(data.tie_nodes[2 * n + 1]),
                  data.tie_length[n], weight * data.tie_stiffness[n],
                  static_cast<Law>(data.tie_law[n])};
    return out;
}

inline Buffer<Attachments::Clamp> Attachments::clamps_of(const LineData& data, double weight) {
    Buffer<Clamp> out(data.clamps);
    for (int n = 0; n < data.clamps; ++n)
        out[n] = {static_cast<int>(data.clamp_nodes[2 * n]),
                  static_cast<int>(data.clamp_nodes[2 * n + 1]), weight * data.clamp_stiffness[n]};
    return out;
}

inline Buffer<Attachments::Stay> Attachments::stays_of(const LineData& data, double weight) {
    Buffer<Stay> out(data.stays);
    for (int n = 0; n < data.stays; ++n) {
        const double* end = data.stay_end + 3 * n;
        out[n] = {static_cast<int>(data.stay_node[n]), {end[0], end[1], end[2]}, data.stay_length[n],
                  weight * data.stay_stiffness[n], static_cast<Law>(data.stay_law[n])};
    }
    return out;
}

inline Buffer<Attachments::Ground> Attachments::grounds_of(
    const LineData& data, const Buffer<Stay>& stays, double weight) {
    Buffer<Ground> out(data.grounds + data.stays);
    for (int n = 0; n < data.grounds; ++n) {
        out[n].node = static_cast<int>(data.ground_node[n]);
        for (int i = 0; i < 3; ++i) {
            out[n].free[i] = data.ground_free[3 * n + i];
            for (int j = 0; j < 3; ++j) {
                out[n].stiffness[i][j] = weight * data.ground_stiffness[9 * n + 3 * i + j];
                out[n].damping[i][j] = weight * data.ground_damping[9 * n + 3 * i + j];
            }
        }
    }
    for (int n = 0; n < data.stays; ++n) {
        const Stay& stay = stays[n];
        Ground& ground = out[data.grounds + n];
        ground.node = stay.node;
        double w[3], square = 0.0;
        for (int i = 0; i < 3; ++i) {
            w[i] = data.position[6 * stay.node + i] - stay.end[i];
            square += w[i] * w[i];
        }
        if (!acts(stay.law, std::sqrt(square) - stay.length)) continue;
        bar_stiffness(w, data.damping_stiffness * stay.stiffness, stay.length, ground.damping);
    }
    return out;
}

template <class T>
Buffer<std::int64_t> Attachments::nodes_of(const Buffer<T>& parts) {
    Buffer<std::int64_t> out(parts.size());
    for (std::size_t n = 0; n < parts.size(); ++n) out[n] = parts[n].node;
    return out;
}

inline Attachments::Attachments(const LineData& data, const Line& line)
    : ties(ties_of(data, line.weight)),
      clamps(clamps_of(data, line.weight)),
      stays(stays_of(data, line.weight)),
      grounds(grounds_of(data, stays, line.weight)),
      layout_(line.layout),
      weight_(line.weight),
      upper_(layout_, data.ties, data.tie_nodes, 2),
      lower_(layout_, data.ties, data.tie_nodes + 1, 2),
      host_(layout_, data.clamps, data.clamp_nodes, 2),
      other_(layout_, data.clamps, data.clamp_nodes + 1, 2),
      stayed_(layout_, data.stays, nodes_of(stays).data(), 1),
      grounded_(layout_, static_cast<int>(grounds.size()), nodes_of(grounds).data(), 1),
      ties_(data.ties, data.tie_length, data.tie_stiffness, data.tie_law, line.weight,
            data.damping_stiffness),
      stays_(data.stays, data.stay_length, data.stay_stiffness, data.stay_law, line.weight, 0.0),
      clamp_stiffness_(host_.registers()),
      clamp_offset_(3 * host_.registers()),
      stay_end_(3 * stayed_.registers()),
      ground_stiffness_(9 * grounded_.registers()),
      ground_damping_(9 * grounded_.registers()),
      ground_free_(3 * grounded_.registers()),
      kept_(6 * (ties.size() + clamps.size()) + 3 * (stays.size() + grounds.size())) {
    for (int n = 0; n < data.clamps; ++n) {
        clamp_stiffness_[n / kLanes][n % kLanes] = clamps[n].stiffness;
        for (int i = 0; i < 3; ++i)
            clamp_offset_[n / kLanes * 3 + i][n % kLanes] = data.clamp_offset[3 * n + i];
    }
    pack();
}

// Copy stays and grounds to registers.
inline void Attachments::pack() {
    for (std::size_t n = 0; n < stays.size(); ++n)
        for (int i = 0; i < 3; ++i) stay_end_[n / kLanes * 3 + i][n % kLanes] = stays[n].end[i];
    for (std::size_t n = 0; n < grounds.size(); ++n) {
        const std::size_t k = n / kLanes, lane = n % kLanes;
        for (int i = 0; i < 3; ++i) {
            ground_free_[3 * k + i][lane] = grounds[n].free[i];
            for (int j = 0; j < 3; ++j) {
                ground_stiffness_[9 * k + 3 * i + j][lane] = grounds[n].stiffness[i][j];
                ground_damping_[9 * k + 3 * i + j][lane] = grounds[n].damping[i][j];
            }
        }
    }
}

TAUTWIRE_INLINE void Attachments::add(const NodeList& nodes, int k, const Doubles (&f)[3], double sign) {
    const int* at = nodes.at(k);
    const int filled = nodes.filled(k);
    for (int lane = 0; lane < filled; ++lane)
        for (int i = 0; i < 3; ++i) {
            const int place = at[lane] + i * kLanes;
            kept_[kept_count_++] = {place, force_[place]};
            force_[place] += sign * f[i][lane];
        }
}

inline void Attachments::push_ties(const MotionView& view, const RowSet& set) {
    for (int k = 0; k < upper_.registers(); ++k) {
        if (!upper_.meets(set, k) && !lower_.meets(set, k)) continue;
        Doubles t[3], rate[3], q[3], v[3];
        upper_.move(view, k, t, rate);
        lower_.move(view, k, q, v);
        for (int i = 0; i < 3; ++i) {
            t[i] -= q[i];
            rate[i] -= v[i];
        }
        const Doubles tension = ties_.tension(k, t, rate);
        ties_.note(k, tension);
        for (Doubles& component : t) component *= tension;
        add(lower_, k, t, 1.0);
        add(upper_, k, t, -1.0);
    }
}

inline void Attachments::push_clamps(const MotionView& view, const RowSet& set) {
    for (int k = 0; k < host_.registers(); ++k) {
        if (!host_.meets(set, k) && !other_.meets(set, k)) continue;
        Doubles f[3], q[3], unused[3];
        other_.move(view, k, f, unused);
        host_.move(view, k, q, unused);
        for (int i = 0; i < 3; ++i)
            f[i] = clamp_stiffness_[k] * (f[i] - q[i] - clamp_offset_[3 * k + i]);
        add(host_, k, f, 1.0);
        add(other_, k, f, -1.0);
    }
}

inline void Attachments::push_stays(const MotionView& view, const RowSet& set) {
    for (int k = 0; k < stayed_.registers(); ++k) {
        if (!stayed_.meets(set, k)) continue;
        Doubles t[3], rate[3];
        stayed_.move(view, k, t, rate);
        for (int i = 0; i < 3; ++i) t[i] -= stay_end_[3 * k + i];
        const Doubles tension = stays_.tension(k, t, rate);
        stays_.note(k, tension);
        for (Doubles& component : t) component *= tension;
        add(stayed_, k, t, -1.0);
    }
}

inline void Attachments::push_grounds(const MotionView& view, const RowSet& set) {
    for (int k = 0; k < grounded_.registers(); ++k) {
        if (!grounded_.meets(set, k)) continue;
        Doubles q[3], v[3], f[3];
        grounded_.move(view, k, q, v);
        for (int i = 0; i < 3; ++i) q[i] -= ground_free_[3 * k + i];
        for (int i = 0; i < 3; ++i) {
            const Doubles* stiffness = &ground_stiffness_[9 * k + 3 * i];
            const Doubles* damping = &ground_damping_[9 * k + 3 * i];
            f[i] = stiffness[0] * q[0] + stiffness[1] * q[1] + stiffness[2] * q[2] +
                   damping[0] * v[0] + damping[1] * v[1] + damping[2] * v[2];
        }
        add(grounded_, k, f, -1.0);
    }
}

inline void Attachments::push(const MotionView& view, Buffer<Row>& force, const RowSet& set) {
    force_ = reinterpret_cast<double*>(force.data());
    kept_count_ = 0;
    push_ties(view, set);
    push_clamps(view, set);
    push_stays(view, set);
    push_grounds(view, set);
}

inline void Attachments::release(Buffer<Row>& force) {
    auto* out = reinterpret_cast<double*>(force.data());
    while (kept_count_ > 0) {
        const Kept& kept = kept_[--kept_count_];
        out[kept.at] = kept.force;
    }
}

inline void Attachments::tie_forces(const MotionView& view, double* out) const {
    for (int k = 0; k < upper_.registers(); ++k) {
        Doubles t[3], rate[3], q[3], v[3];
        upper_.move(view, k, t, rate);
        lower_.move(view, k, q, v);
        for (int i = 0; i < 3; ++i) {
            t[i] -= q[i];
            rate[i] -= v[i];
        }
        const Doubles force = square_root(dot(t, t)) * ties_.tension(k, t, rate);
        for (int lane = 0; lane < upper_.filled(k); ++lane)
            out[k * kLanes + lane] = force[lane] / weight_;
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
