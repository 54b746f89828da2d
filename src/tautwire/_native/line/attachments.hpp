// What joins wires and holds them: ties, clamps, stays and grounds, on any node of any wire.
//
// Each kind is a list, evaluated one register at a time from the gathered motion of the nodes. The
// forces are then added to the nodal forces, row by row.
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

// Sort parts of the line by the rows of their nodes; those in one row keep their order.
template <class T>
void sort_by_row(const Layout& layout, int T::*node, Buffer<T>& parts) {
    Buffer<int> place(layout.rows + 1);
    for (const T& part : parts) ++place[layout.slot(part.*node).row + 1];
    for (int row = 0; row < layout.rows; ++row) place[row + 1] += place[row];
    Buffer<T> sorted(parts.size());
    for (const T& part : parts) sorted[place[layout.slot(part.*node).row]++] = part;
    parts = std::move(sorted);
}

// Nodes of a list of parts, which are sorted by row, in registers; the last register repeats the last
// node.
class NodeList {
public:
    template <class T>
    NodeList(const Layout& layout, const Buffer<T>& parts, int T::*node)
        : count_(static_cast<int>(parts.size())), at_(static_cast<std::size_t>(registers() * kLanes)),
          span_(static_cast<std::size_t>(registers())) {
        for (std::size_t n = 0; n < at_.size(); ++n)
            at_[n] = layout.in_doubles(parts[n < parts.size() ? n : parts.size() - 1].*node);
        for (int k = 0; k < registers(); ++k) {
            Span& span = span_[k] = {row(k, 0), row(k, 0)};
            for (int lane = 1; lane < kLanes; ++lane) {
                span.first = span.first < row(k, lane) ? span.first : row(k, lane);
                span.last = span.last > row(k, lane) ? span.last : row(k, lane);
            }
        }
    }

    static int registers(int count) { return (count + kLanes - 1) / kLanes; }
    int registers() const { return registers(count_); }
    // Entries of a register that are not repeated.
    int filled(int k) const { return count_ - k * kLanes < kLanes ? count_ - k * kLanes : kLanes; }
    const int* at(int k) const { return &at_[k * kLanes]; }
    int row(int k, int lane) const { return at(k)[lane] / (12 * kLanes); }
    // Whether there are formed rows among those from the first to the last of the nodes of a register.
    bool meets(const RowSet& set, int k) const {
        return set.count_formed(span_[k].first, span_[k].last) > 0;
    }
    // The first register of a part: those that begin in its rows are its own.
    int first(const Layout& layout, int part) const {
        int k = 0;
        while (k < registers() && row(k, 0) < layout.bound(part)) ++k;
        return k;
    }

    // Gather position (velocity) of the nodes of a register.
    TAUTWIRE_INLINE void move(const MotionView& view, int k, Doubles (&q)[3], Doubles (&v)[3]) const {
        const auto* from_q = reinterpret_cast<const double*>(view.q_p.data());
        const auto* from_v = reinterpret_cast<const double*>(view.v_p.data());
        const auto* from_a = reinterpret_cast<const double*>(view.a.data());
        const int* at = &at_[k * kLanes];
        for (int i = 0; i < 3; ++i) {
            q[i] = gather(from_q + i * kLanes, at);
            v[i] = gather(from_v + i * kLanes, at);
            const Doubles a = gather(from_a + i * kLanes, at);
            q[i] += view.q_of_v * v[i] + view.q_of_a * a;
            v[i] += view.v_of_a * a;
        }
    }

private:
    int count_;
    Buffer<int> at_;  // where the first coordinate of a node stands, as a number
    struct Span {
        int first, last;
    };
    Buffer<Span> span_;  // rows of the registers
};

// Axial force of bars: stiffness (l - length) + damping dl/dt, as far as their law lets it act.
struct Bars {
    Buffer<Doubles> length, stiffness, damping, least, most;  // [register]
    Buffer<unsigned char> acting;  // which carried force at the last evaluation; always, if linear

    template <class T>
    Bars(const Buffer<T>& parts, double damping_per_stiffness)
        : length(NodeList::registers(static_cast<int>(parts.size()))), stiffness(length.size()),
          damping(length.size()), least(length.size()), most(length.size()),
          acting(length.size() * kLanes) {
        for (Doubles& x : length) x = broadcast<Doubles>(1.0);
        for (std::size_t n = 0; n < parts.size(); ++n) {
            const std::size_t k = n / kLanes, lane = n % kLanes;
            const T& part = parts[n];
            length[k][lane] = part.length;
            stiffness[k][lane] = part.stiffness;
            damping[k][lane] = damping_per_stiffness * part.stiffness;
            least[k][lane] = part.law == Law::tension_only ? 0.0 : -kInfinity;
            most[k][lane] = part.law == Law::compression_only ? 0.0 : kInfinity;
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

    // Evaluate the forces of a part, of everything that has an end in formed rows.
    void evaluate(const MotionView& view, const RowSet& set, int part);
    // When all parts are evaluated, add their forces to those on the nodes in the formed rows of a part;
    // release takes them away again, exactly.
    void push(Buffer<Row>& force, const RowSet& set, int part);
    void release(Buffer<Row>& force, const RowSet& set, int part);

    // Axial forces of the ties of a part.
    void tie_forces(const MotionView& view, double* out, int part) const;

    // Which ties and stays carried force when last evaluated (1 or 0); the linear ones always.
    const Buffer<unsigned char>& acting_ties() const { return ties_.acting; }
    const Buffer<unsigned char>& acting_stays() const { return stays_.acting; }

    // The parts, by rows; what matrices need, and the number of a tie in the data.
    struct Tie {
        int upper, lower, number;
        double length, stiffness;
        Law law;
    };
    struct Clamp {
        int host, other;
        double stiffness, offset[3];
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
    Buffer<Ground> grounds;  // those of the line and the damping of the stays

private:
    static Buffer<Tie> ties_of(const LineData& data, const Line& line);
    static Buffer<Clamp> clamps_of(const LineData& data, const Line& line);
    static Buffer<Stay> stays_of(const LineData& data, const Line& line);
    static Buffer<Ground> grounds_of(const LineData& data, const Buffer<Stay>& stays, const Line& line);
    void pack();

    static constexpr int kKinds = 4;  // ties, clamps, stays, grounds

    // Whether a register has an end in formed rows.
    bool meets(const RowSet& set, int kind, int k) const {
        const NodeList* ends[kKinds][2] = {
            {&lower_, &upper_}, {&host_, &other_}, {&stayed_, nullptr}, {&grounded_, nullptr}};
        return ends[kind][0]->meets(set, k) || (ends[kind][1] && ends[kind][1]->meets(set, k));
    }
    TAUTWIRE_INLINE void evaluate(const MotionView& view, int kind, int k, Doubles (&out)[3]);
    void list_effects();
    const Layout& layout_;
    double weight_;
    NodeList upper_, lower_, host_, other_, stayed_, grounded_;
    Bars ties_, stays_;
    // [register][component]
    Buffer<Doubles> clamp_stiffness_, clamp_offset_, stay_end_, ground_stiffness_, ground_damping_,
        ground_free_;
    int begin_[kKinds];                   // registers of the kinds before
    int first_[kKinds][kMostParts + 1];  // first register of a part, and the one behind the last
    // What a force does to a node: which one, as a number of found_, with which sign; where in an
    // array of rows its first component acts, as a number, and what stood there.
    struct Effect {
        int from, at, row;
        double sign, before[3];
    };
    Buffer<Effect> effects_;  // row by row
    Buffer<int> first_effect_;  // [row], and behind the last
    Buffer<Doubles> found_;  // [register][component], kind after kind: the forces that were evaluated
};

inline Buffer<Attachments::Tie> Attachments::ties_of(const LineData& data, const Line& line) {
    Buffer<Tie> out(data.ties);
    for (int n = 0; n < data.ties; ++n)
        out[n] = {static_cast<int>(data.tie_nodes[2 * n]), static_cast<int>(data.tie_nodes[2 * n + 1]),
                  n, data.tie_length[n], line.weight * data.tie_stiffness[n],
                  static_cast<Law>(data.tie_law[n])};
    sort_by_row(line.layout, &Tie::lower, out);
    return out;
}

inline Buffer<Attachments::Clamp> Attachments::clamps_of(const LineData& data, const Line& line) {
    Buffer<Clamp> out(data.clamps);
    for (int n = 0; n < data.clamps; ++n) {
        const double* offset = data.clamp_offset + 3 * n;
        out[n] = {static_cast<int>(data.clamp_nodes[2 * n]),
                  static_cast<int>(data.clamp_nodes[2 * n + 1]), line.weight * data.clamp_stiffness[n],
                  {offset[0], offset[1], offset[2]}};
    }
    sort_by_row(line.layout, &Clamp::host, out);
    return out;
}

inline Buffer<Attachments::Stay> Attachments::stays_of(const LineData& data, const Line& line) {
    Buffer<Stay> out(data.stays);
    for (int n = 0; n < data.stays; ++n) {
        const double* end = data.stay_end + 3 * n;
        out[n] = {static_cast<int>(data.stay_node[n]), {end[0], end[1], end[2]}, data.stay_length[n],
                  line.weight * data.stay_stiffness[n], static_cast<Law>(data.stay_law[n])};
    }
    sort_by_row(line.layout, &Stay::node, out);
    return out;
}

inline Buffer<Attachments::Ground> Attachments::grounds_of(
    const LineData& data, const Buffer<Stay>& stays, const Line& line) {
    Buffer<Ground> out(data.grounds + data.stays);
    for (int n = 0; n < data.grounds; ++n) {
        out[n].node = static_cast<int>(data.ground_node[n]);
        for (int i = 0; i < 3; ++i) {
            out[n].free[i] = data.ground_free[3 * n + i];
            for (int j = 0; j < 3; ++j) {
                out[n].stiffness[i][j] = line.weight * data.ground_stiffness[9 * n + 3 * i + j];
                out[n].damping[i][j] = line.weight * data.ground_damping[9 * n + 3 * i + j];
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
    sort_by_row(line.layout, &Ground::node, out);
    return out;
}

inline Attachments::Attachments(const LineData& data, const Line& line)
    : ties(ties_of(data, line)),
      clamps(clamps_of(data, line)),
      stays(stays_of(data, line)),
      grounds(grounds_of(data, stays, line)),
      layout_(line.layout),
      weight_(line.weight),
      upper_(layout_, ties, &Tie::upper),
      lower_(layout_, ties, &Tie::lower),
      host_(layout_, clamps, &Clamp::host),
      other_(layout_, clamps, &Clamp::other),
      stayed_(layout_, stays, &Stay::node),
      grounded_(layout_, grounds, &Ground::node),
      ties_(ties, data.damping_stiffness),
      stays_(stays, 0.0),
      clamp_stiffness_(host_.registers()),
      clamp_offset_(3 * host_.registers()),
      stay_end_(3 * stayed_.registers()),
      ground_stiffness_(9 * grounded_.registers()),
      ground_damping_(9 * grounded_.registers()),
      ground_free_(3 * grounded_.registers()) {
    pack();
    list_effects();
}

// List what every force does, in the order of the rows; on one node, in the order of the kinds.
inline void Attachments::list_effects() {
    struct Side {
        const NodeList& nodes;
        std::size_t count;
        int kind;
        double sign;
    };
    const Side sides[] = {{lower_, ties.size(), 0, 1.0},    {upper_, ties.size(), 0, -1.0},
                          {host_, clamps.size(), 1, 1.0},   {other_, clamps.size(), 1, -1.0},
                          {stayed_, stays.size(), 2, -1.0}, {grounded_, grounds.size(), 3, -1.0}};
    int count = 0;
    const NodeList* kinds[kKinds] = {&lower_, &host_, &stayed_, &grounded_};
    for (int kind = 0; kind < kKinds; count += kinds[kind++]->registers()) {
        begin_[kind] = count;
        for (int part = 0; part <= layout_.parts; ++part) first_[kind][part] = kinds[kind]->first(layout_, part);
    }
    found_ = Buffer<Doubles>(3 * static_cast<std::size_t>(count));

    List<Effect> effects;
    Buffer<int> place(layout_.rows + 1);
    for (const Side& side : sides)
        for (std::size_t n = 0; n < side.count; ++n) {
            const int k = static_cast<int>(n) / kLanes, lane = static_cast<int>(n) % kLanes;
            const int row = side.nodes.row(k, lane);
            effects.push({3 * (begin_[side.kind] + k) * kLanes + lane, side.nodes.at(k)[lane], row,
                          side.sign, {}});
            ++place[row + 1];
        }
    for (int row = 0; row < layout_.rows; ++row) place[row + 1] += place[row];
    first_effect_ = Buffer<int>(place.size());
    first_effect_.copy_from(place);
    effects_ = Buffer<Effect>(effects.size());
    for (const Effect& effect : effects) effects_[place[effect.row]++] = effect;
}

// Copy clamps, stays and grounds to registers.
inline void Attachments::pack() {
    for (std::size_t n = 0; n < clamps.size(); ++n) {
        clamp_stiffness_[n / kLanes][n % kLanes] = clamps[n].stiffness;
        for (int i = 0; i < 3; ++i)
            clamp_offset_[n / kLanes * 3 + i][n % kLanes] = clamps[n].offset[i];
    }
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

// Forces of a register on its first node (or, of a bar, on the lower or from the fixed one).
TAUTWIRE_INLINE void Attachments::evaluate(
    const MotionView& view, int kind, int k, Doubles (&out)[3]) {
    Doubles q[3], v[3];
    if (kind < 2) {
        Doubles rate[3];
        const NodeList &from = kind == 0 ? upper_ : other_, &to = kind == 0 ? lower_ : host_;
        from.move(view, k, out, rate);
        to.move(view, k, q, v);
        for (int i = 0; i < 3; ++i) {
            out[i] -= q[i];
            rate[i] -= v[i];
        }
        if (kind == 1) {
            for (int i = 0; i < 3; ++i)
                out[i] = clamp_stiffness_[k] * (out[i] - clamp_offset_[3 * k + i]);
            return;
        }
        const Doubles tension = ties_.tension(k, out, rate);
        ties_.note(k, tension);
        for (Doubles& component : out) component *= tension;
    } else if (kind == 2) {
        stayed_.move(view, k, out, v);
        for (int i = 0; i < 3; ++i) out[i] -= stay_end_[3 * k + i];
        const Doubles tension = stays_.tension(k, out, v);
        stays_.note(k, tension);
        for (Doubles& component : out) component *= tension;
    } else {
        grounded_.move(view, k, q, v);
        for (int i = 0; i < 3; ++i) q[i] -= ground_free_[3 * k + i];
        for (int i = 0; i < 3; ++i) {
            const Doubles* stiffness = &ground_stiffness_[9 * k + 3 * i];
            const Doubles* damping = &ground_damping_[9 * k + 3 * i];
            out[i] = stiffness[0] * q[0] + stiffness[1] * q[1] + stiffness[2] * q[2] +
                     damping[0] * v[0] + damping[1] * v[1] + damping[2] * v[2];
        }
    }
}

inline void Attachments::evaluate(const MotionView& view, const RowSet& set, int part) {
    for (int kind = 0; kind < kKinds; ++kind)
        for (int k = first_[kind][part]; k < first_[kind][part + 1]; ++k) {
            if (!meets(set, kind, k)) continue;
            Doubles f[3];
            evaluate(view, kind, k, f);
            for (int i = 0; i < 3; ++i) found_[3 * (begin_[kind] + k) + i] = f[i];
        }
}

inline void Attachments::push(Buffer<Row>& force, const RowSet& set, int part) {
    auto* out = reinterpret_cast<double*>(force.data());
    const auto* found = reinterpret_cast<const double*>(found_.data());
    const int last = first_effect_[layout_.bound(part + 1)];
    for (int n = first_effect_[layout_.bound(part)]; n < last; ++n) {
        Effect& effect = effects_[n];
        if (!set.formed[effect.row]) continue;
        for (int i = 0; i < 3; ++i) {
            double& place = out[effect.at + i * kLanes];
            effect.before[i] = place;
            place += effect.sign * found[effect.from + i * kLanes];
        }
    }
}

inline void Attachments::release(Buffer<Row>& force, const RowSet& set, int part) {
    auto* out = reinterpret_cast<double*>(force.data());
    const int first = first_effect_[layout_.bound(part)];
    for (int n = first_effect_[layout_.bound(part + 1)]; n-- > first;) {
        const Effect& effect = effects_[n];
        if (!set.formed[effect.row]) continue;
        for (int i = 0; i < 3; ++i) out[effect.at + i * kLanes] = effect.before[i];
    }
}

inline void Attachments::tie_forces(const MotionView& view, double* out, int part) const {
    for (int k = first_[0][part]; k < first_[0][part + 1]; ++k) {
        Doubles t[3], rate[3], q[3], v[3];
        upper_.move(view, k, t, rate);
        lower_.move(view, k, q, v);
        for (int i = 0; i < 3; ++i) {
            t[i] -= q[i];
            rate[i] -= v[i];
        }
        const Doubles force = square_root(dot(t, t)) * ties_.tension(k, t, rate);
        for (int lane = 0; lane < upper_.filled(k); ++lane)
            out[ties[k * kLanes + lane].number] = force[lane] / weight_;
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
