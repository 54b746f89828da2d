// What couples the nodes of the chain beyond their neighbours, as low-rank part of the matrix.
//
// The chain's factor P = L D L' leaves out ties, clamps, one-sided stays and contacts. Each of them
// is a column n with a stiffness kappa, and with w = L^-1 n, z = D^-1 w
//
//     (P + sum kappa n n')^-1 r = L^-T D^-1 (y - W S^-1 Z' y),   y = L^-1 r,   S = 1/kappa + Z' W.
//
// Columns fade within a few nodes; S is sparse and is factored in the order along the track. Columns
// and S are cut off where that costs little convergence.
#pragma once

#include "chain/assembly.hpp"
#include "chain/chain.hpp"
#include "chain/skyline.hpp"

namespace tautwire::TAUTWIRE_ISA {

class Couplings {
public:
    Couplings(const Line& line, const Attachments& attached)
        : line_(line), attached_(attached) {}

    // Set up the couplings of the line for a factored chain at a state; false when they are not
    // positive definite.
    bool set(const Chain& chain, const Factors& factors, const Buffer<Row>& state,
             const Buffer<int>& rank);

    // Replace the contacts: clear, then add the direction (of the reference state) in which each one
    // acts on `node` and the next, and its stiffness.
    void clear_contacts();
    void add_contact(const Chain& chain, int node, const double (&rhs)[2][6], double kappa);
    int contacts() const { return static_cast<int>(couplings_.size()) - line_count_; }

    // Correct an eliminated right-hand side y for what acts: Z' y of all parts, then the solution
    // with S, then y - W s in all parts. `closed` and `compliance` tell of the contacts: which are
    // closed, and what stands in S in place of 1/kappa, all pairs of them.
    void project(Chain& chain, const RowSet& set, int part);
    bool solve(const bool* closed, const double* compliance);
    void apply(Chain& chain, const RowSet& set, int part) const;

private:
    // Aimed-at contraction of an iteration by what is cut off; the tangent's change alone is worth
    // about as much. Chosen: 5e-4 and 1e-2 change 2.13 iterations per step of AC simple to 2.13 and
    // 2.26, and no time.
    static constexpr double kContraction = 2e-3;
    // Finest and coarsest cut-off, relative to the column. Chosen: 1e-4 and 0.3 change no count of
    // AC simple, AC stitched and DC twin by one in a thousand.
    static constexpr double kLeastCut = 3e-4, kMostCut = 0.1;

    enum class Gate { none, tie, stay, contact };
    struct Entry {
        int at;
        float w, z;
    };
    struct End {
        int coupling, node, last_node;
        int first, last;  // entries, last excluded
    };
    // Entries of an end in rows of a part that follow each other, last excluded, and these rows.
    struct Section {
        int coupling, first, last;
        int row, last_row;
    };
    struct Coupling {
        int rank, index, node[2];
        Gate gate;
        double kappa, direction[3];
        int first_end, last_end;
    };
    struct Pair {
        int k, l, e, f;  // couplings k >= l, ends
        double response;
    };
    void list(const Factors& factors, const Buffer<Row>& state, const Buffer<int>& rank);
    void sort();
    void add_ends(const Chain& chain, int k);
    void add_end(const Chain& chain, int k, int node, const double (&rhs)[2][6]);
    void cut(int k);
    void pair_up(int e, int f);
    void divide(const End& end);
    void make_room();
    double response(const End& e, const End& f) const;
    bool acts(const Coupling& coupling, const bool* closed) const {
        switch (coupling.gate) {
            case Gate::tie: return attached_.acting_ties()[coupling.index];
            case Gate::stay: return attached_.acting_stays()[coupling.index];
            case Gate::contact: return closed[coupling.index];
            default: return true;
        }
    }
    bool prepare(const bool* closed, const double* compliance);
    void fill(int from, const double* compliance);
    // A section with solved rows; whether all its rows are.
    struct Visited {
        int coupling, first, last;
        bool is_whole;
    };
    void find_visited(const RowSet& set, int part);
    template <class F>
    void visit(const Visited& section, const RowSet& set, F f) const;

    static int row_of(const Entry& entry) { return entry.at / (6 * kPieces); }

    const Line& line_;
    const Attachments& attached_;
    List<Coupling> couplings_;  // those of the line along the track, then the contacts
    List<End> ends_;
    List<Entry> entries_;
    List<int> dofs_;       // of the entries
    List<float> sizes_;  // of the entries of the coupling that is being made
    List<Pair> pairs_;
    int line_count_ = 0, line_ends_ = 0, line_entries_ = 0, line_pairs_ = 0;
    Buffer<int> by_node_;  // ends of the line, sorted
    int longest_ = 0;      // most nodes between the first and the last of an end
    Skyline matrix_;       // S
    List<unsigned char> active_;
    int factored_ = 0;  // rows of S that are up to date
    Buffer<double> small_;
    // What threads work on side by side, each part on cache lines of its own.
    struct alignas(64) Part {
        List<Section> sections;
        int line_sections = 0;
        List<Visited> visited;     // by the last projection
        Buffer<float> projected;  // [coupling]
    };
    Part parts_[kMostParts];
};

inline void Couplings::list(
    const Factors& factors, const Buffer<Row>& state, const Buffer<int>& rank) {
    const Layout& layout = line_.layout;
    const double of_ties = factors.stiffness + factors.damping * line_.damping_stiffness;
    couplings_.shorten(0);
    const auto add = [&](Gate gate, int index, int a, int b, double kappa, const double (&w)[3]) {
        const int place = b < 0 || rank[a] < rank[b] ? rank[a] : rank[b];
        const double length = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        if (kappa > 0.0)
            couplings_.push({place, index, {a, b}, gate, kappa,
                             {w[0] / length, w[1] / length, w[2] / length}, 0, 0});
    };
    double w[3];
    for (std::size_t n = 0; n < attached_.ties.size(); ++n) {
        const auto& tie = attached_.ties[n];
        for (int i = 0; i < 3; ++i)
            w[i] = value(state, layout, tie.upper, i) - value(state, layout, tie.lower, i);
        add(Gate::tie, static_cast<int>(n), tie.upper, tie.lower, of_ties * tie.stiffness, w);
    }
    for (const auto& clamp : attached_.clamps)
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) w[j] = i == j;
            add(Gate::none, 0, clamp.host, clamp.other, factors.stiffness * clamp.stiffness, w);
        }
    for (std::size_t n = 0; n < attached_.stays.size(); ++n) {
        const auto& stay = attached_.stays[n];
        if (stay.law == Law::both_ways) continue;
        for (int i = 0; i < 3; ++i) w[i] = value(state, layout, stay.node, i) - stay.end[i];
        add(Gate::stay, static_cast<int>(n), stay.node, -1, factors.stiffness * stay.stiffness, w);
    }
}

// Order the couplings along the track; those at one place keep their order.
inline void Couplings::sort() {
    Buffer<int> start(line_.layout.nodes + 1);
    for (const Coupling& c : couplings_) ++start[c.rank + 1];
    for (int i = 0; i < line_.layout.nodes; ++i) start[i + 1] += start[i];
    Buffer<Coupling> sorted(couplings_.size());
    for (const Coupling& c : couplings_) sorted[start[c.rank]++] = c;
    for (std::size_t k = 0; k < sorted.size(); ++k) couplings_[k] = sorted[k];
}

inline bool Couplings::set(const Chain& chain, const Factors& factors, const Buffer<Row>& state,
                           const Buffer<int>& rank) {
    list(factors, state, rank);
    sort();
    ends_.shorten(0);
    entries_.shorten(0);
    dofs_.shorten(0);
    pairs_.shorten(0);
    line_count_ = static_cast<int>(couplings_.size());
    for (Part& part : parts_) part.sections.shorten(0);
    for (int k = 0; k < line_count_; ++k) add_ends(chain, k);
    for (const End& end : ends_) divide(end);
    for (Part& part : parts_) part.line_sections = static_cast<int>(part.sections.size());
    line_ends_ = static_cast<int>(ends_.size());
    line_entries_ = static_cast<int>(entries_.size());

    Buffer<int> start(line_.layout.nodes + 1);
    for (const End& end : ends_) ++start[end.node + 1];
    for (int i = 0; i < line_.layout.nodes; ++i) start[i + 1] += start[i];
    by_node_ = Buffer<int>(line_ends_);
    longest_ = 0;
    for (int e = 0; e < line_ends_; ++e) {
        by_node_[start[ends_[e].node]++] = e;
        const int length = ends_[e].last_node - ends_[e].node;
        longest_ = longest_ > length ? longest_ : length;
    }
    for (int i = 0; i < line_ends_; ++i)
        for (int j = i; j < line_ends_; ++j) {
            if (ends_[by_node_[j]].node > ends_[by_node_[i]].last_node) break;
            pair_up(by_node_[i], by_node_[j]);
        }
    line_pairs_ = static_cast<int>(pairs_.size());

    Buffer<int> first(line_count_);
    for (int k = 0; k < line_count_; ++k) first[k] = k;
    for (const Pair& pair : pairs_) first[pair.k] = first[pair.k] < pair.l ? first[pair.k] : pair.l;
    matrix_.clear();
    active_.shorten(0);
    for (int k = 0; k < line_count_; ++k) {
        matrix_.add_row(first[k]);
        active_.push(1);
    }
    make_room();
    fill(0, nullptr);
    const bool done = matrix_.factor(0);
    factored_ = done ? line_count_ : 0;
    return done;
}

// Make room for a number per coupling and for all sections, before threads use it.
inline void Couplings::make_room() {
    small_.grow(couplings_.size());
    for (Part& part : parts_) {
        part.projected.grow(couplings_.size());
        part.visited.reserve(part.sections.size());
    }
}

inline void Couplings::add_ends(const Chain& chain, int k) {
    Coupling& c = couplings_[k];
    c.first_end = static_cast<int>(ends_.size());
    for (int side = 0; side < 2; ++side) {
        if (c.node[side] < 0) continue;
        double rhs[2][6] = {};
        for (int i = 0; i < 3; ++i)
            if (!line_.is_held(c.node[side], i)) rhs[0][i] = (side ? -1.0 : 1.0) * c.direction[i];
        add_end(chain, k, c.node[side], rhs);
    }
    c.last_end = static_cast<int>(ends_.size());
    cut(k);
}

// Add a column with everything that has not quite faded.
inline void Couplings::add_end(const Chain& chain, int k, int node, const double (&rhs)[2][6]) {
    const Layout& layout = line_.layout;
    End end = {k, node, node, static_cast<int>(entries_.size()), 0};
    double total = 0.0;
    chain.eliminate_from(node, rhs, [&](int m, const double* w, const double* z, const double* d) {
        const int at = layout.in_floats(m);
        double here = 0.0;
        for (int i = 0; i < 6; ++i) {
            here += w[i] * z[i];
            entries_.push({at + i * kPieces, static_cast<float>(w[i]), static_cast<float>(z[i])});
            dofs_.push(6 * m + i);
            const double of_w = w[i] * w[i] * d[i], of_z = z[i] * z[i] / d[i];
            sizes_.push(static_cast<float>(of_w > of_z ? of_w : of_z));
        }
        total += here;
        end.last_node = m;
        return m == node || here > kLeastCut * kLeastCut * total;
    });
    end.last = static_cast<int>(entries_.size());
    ends_.push(end);
}

// Drop the small entries of a coupling's columns: with a share tau of its length left out, a column
// of stiffness kappa and compliance z'w lets the iteration contract by about tau kappa z'w.
inline void Couplings::cut(int k) {
    const Coupling& c = couplings_[k];
    double compliance = 0.0;
    for (int e = c.first_end; e < c.last_end; ++e)
        for (int n = ends_[e].first; n < ends_[e].last; ++n)
            compliance += static_cast<double>(entries_[n].w) * entries_[n].z;
    double tau = kContraction / (c.kappa * compliance);
    tau = tau < kLeastCut ? kLeastCut : tau > kMostCut ? kMostCut : tau;
    const int start = ends_[c.first_end].first;
    int kept = start;
    for (int e = c.first_end; e < c.last_end; ++e) {
        End& end = ends_[e];
        const int first = kept;
        for (int n = end.first; n < end.last; ++n) {
            const Entry entry = entries_[n];
            if (!(sizes_[n - start] > tau * tau * compliance)) continue;
            end.last_node = dofs_[n] / 6;
            dofs_[kept] = dofs_[n];
            entries_[kept++] = entry;
        }
        end.first = first;
        end.last = kept;
    }
    entries_.shorten(kept);
    dofs_.shorten(kept);
    sizes_.shorten(0);
}

// Divide the entries of an end, which lie node after node, where they go on in the next piece or part.
inline void Couplings::divide(const End& end) {
    for (int first = end.first, last = first; first < end.last; first = last) {
        const int row = row_of(entries_[first]), part = line_.layout.part_of(row);
        const int bound = line_.layout.bound(part + 1);
        int last_row = row;
        for (; last < end.last; ++last) {
            const int next = row_of(entries_[last]);
            if (next < last_row || next >= bound) break;
            last_row = next;
        }
        parts_[part].sections.push({end.coupling, first, last, row, last_row});
    }
}

inline double Couplings::response(const End& e, const End& f) const {
    double sum = 0.0;
    for (int m = e.first, n = f.first; m < e.last && n < f.last;) {
        const Entry &a = entries_[m], &b = entries_[n];
        const int at = dofs_[m], other = dofs_[n];
        if (at == other)
            sum += 0.5 * (static_cast<double>(a.w) * b.z + static_cast<double>(a.z) * b.w);
        m += at <= other;
        n += other <= at;
    }
    return sum;
}

inline void Couplings::pair_up(int e, int f) {
    int k = ends_[e].coupling, l = ends_[f].coupling;
    const double g = response(ends_[e], ends_[f]);
    const double kappa = std::sqrt(couplings_[k].kappa * couplings_[l].kappa);
    if (k != l && std::fabs(g) * kappa < kContraction) return;
    if (k < l) {
        const int other = k;
        k = l;
        l = other;
    }
    // Both ends of one coupling on neighbouring nodes stand twice in the product.
    pairs_.push({k, l, e, f, k == l && e != f ? 2.0 * g : g});
}

inline void Couplings::clear_contacts() {
    couplings_.shorten(line_count_);
    ends_.shorten(line_ends_);
    entries_.shorten(line_entries_);
    dofs_.shorten(line_entries_);
    pairs_.shorten(line_pairs_);
    for (Part& part : parts_) part.sections.shorten(part.line_sections);
    matrix_.shorten(line_count_);
    active_.shorten(line_count_);
}

inline void Couplings::add_contact(
    const Chain& chain, int node, const double (&rhs)[2][6], double kappa) {
    const int k = static_cast<int>(couplings_.size()), e = static_cast<int>(ends_.size());
    couplings_.push({0, k - line_count_, {node, -1}, Gate::contact, kappa, {}, e, e + 1});
    add_end(chain, k, node, rhs);
    cut(k);
    divide(ends_[e]);
    int low = 0, high = line_ends_;  // the ends of the line that can reach the contact
    while (low < high) {
        const int middle = (low + high) / 2;
        if (ends_[by_node_[middle]].node < node - longest_) low = middle + 1;
        else high = middle;
    }
    for (; low < line_ends_ && ends_[by_node_[low]].node <= ends_[e].last_node; ++low)
        if (ends_[by_node_[low]].last_node >= node) pair_up(by_node_[low], e);
    for (int other = line_ends_; other <= e; ++other) pair_up(other, e);
    int first = line_count_;
    for (std::size_t n = line_pairs_; n < pairs_.size(); ++n)
        if (pairs_[n].k == k && pairs_[n].l < first) first = pairs_[n].l;
    matrix_.add_row(first);
    active_.push(0);
    make_room();
}

// Fill the rows of S from one on; those of couplings that do not act are decoupled.
inline void Couplings::fill(int from, const double* compliance) {
    matrix_.reset(from);
    for (std::size_t n = from < line_count_ ? 0 : line_pairs_; n < pairs_.size(); ++n) {
        const Pair& pair = pairs_[n];
        if (pair.k >= from && active_[pair.k] && active_[pair.l])
            matrix_.at(pair.k, pair.l) += pair.response;
    }
    for (int k = from; k < matrix_.size(); ++k) {
        double& diagonal = matrix_.at(k, k);
        if (!active_[k]) {
            diagonal = 1.0;
        } else if (k < line_count_) {
            diagonal += 1.0 / couplings_[k].kappa;
        } else {
            for (int l = line_count_; l <= k; ++l)
                if (active_[l])
                    matrix_.at(k, l) += compliance[(k - line_count_) * contacts() + l - line_count_];
        }
    }
}

// Bring the factor of S up to date with what acts.
inline bool Couplings::prepare(const bool* closed, const double* compliance) {
    int from = factored_ < line_count_ ? factored_ : line_count_;  // contacts change always
    for (int k = 0; k < matrix_.size(); ++k) {
        const bool active = acts(couplings_[k], closed);
        if (active_[k] == active) continue;
        active_[k] = active;
        from = from < k ? from : k;
    }
    fill(from, compliance);
    const bool done = matrix_.factor(from);
    factored_ = done ? line_count_ : 0;
    return done;
}

// List the sections of a part that have solved rows.
inline void Couplings::find_visited(const RowSet& set, int part) {
    parts_[part].visited.shorten(0);
    for (const Section& section : parts_[part].sections) {
        const int here = set.count_solved(section.row, section.last_row);
        const bool is_whole = here == section.last_row - section.row + 1;
        if (here > 0) parts_[part].visited.push({section.coupling, section.first, section.last, is_whole});
    }
}

// Call f(entry) for the entries of a visited section in solved rows.
template <class F>
void Couplings::visit(const Visited& section, const RowSet& set, F f) const {
    for (int n = section.first; n < section.last; ++n)
        if (section.is_whole || set.solved[row_of(entries_[n])]) f(entries_[n]);
}

inline void Couplings::project(Chain& chain, const RowSet& set, int part) {
    const float* y = chain.eliminated();
    float* sums = parts_[part].projected.data();
    std::memset(sums, 0, couplings_.size() * sizeof(float));
    find_visited(set, part);
    for (const Visited& section : parts_[part].visited) {
        float even = 0.0f, odd = 0.0f;  // two sums, as additions wait for each other
        if (section.is_whole) {
            int n = section.first;
            for (; n + 1 < section.last; n += 2) {
                even += entries_[n].z * y[entries_[n].at];
                odd += entries_[n + 1].z * y[entries_[n + 1].at];
            }
            if (n < section.last) even += entries_[n].z * y[entries_[n].at];
        } else {
            visit(section, set, [&](const Entry& entry) { even += entry.z * y[entry.at]; });
        }
        sums[section.coupling] += even + odd;
    }
}

inline bool Couplings::solve(const bool* closed, const double* compliance) {
    if (couplings_.size() == 0) return true;
    if (!prepare(closed, compliance)) return false;
    for (int k = 0; k < matrix_.size(); ++k) {
        float sum = 0.0f;
        for (int part = 0; part < line_.layout.parts; ++part) sum += parts_[part].projected[k];
        small_[k] = active_[k] ? sum : 0.0f;
    }
    matrix_.solve(small_.data());
    return true;
}

inline void Couplings::apply(Chain& chain, const RowSet& set, int part) const {
    float* y = chain.eliminated();
    for (const Visited& section : parts_[part].visited) {
        const float factor = static_cast<float>(small_[section.coupling]);
        if (factor == 0.0f) continue;
        visit(section, set, [&](const Entry& entry) { y[entry.at] -= factor * entry.w; });
    }
}

}  // namespace tautwire::TAUTWIRE_ISA
