// What the native core is given and what it offers, the same for every instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tautwire {

// How an axial force may act.
enum class Law : std::int64_t { both_ways = 0, tension_only = 1, compression_only = 2 };
inline constexpr int kLaws = 3;  // the laws above

// The line. Nodes are numbered wire after wire, each from left to right; node i and i + 1 are joined
// by cable i, which has no stiffness and no mass where a wire ends. Arrays are only read while an
// engine is made.
struct LineData {
    int nodes, ties, clamps, stays, grounds, paths;
    const double *length, *axial_stiffness, *bending_stiffness, *mass;  // (nodes - 1,)
    const double* node_mass;                                            // (nodes,)
    const double *load, *position;                                      // (nodes, 6)
    const bool* fixed;                                                  // (nodes, 6)
    const std::int64_t* rank;  // (nodes,): place along the track, so that couplings are short
    // Bars between two nodes, upper node first; `law` holds values of Law.
    const std::int64_t *tie_nodes, *tie_law;        // (ties, 2), (ties,)
    const double *tie_length, *tie_stiffness;       // (ties,)
    // Joints that are springs in every direction, host first.
    const std::int64_t* clamp_nodes;                // (clamps, 2)
    const double *clamp_stiffness, *clamp_offset;   // (clamps,), (clamps, 3)
    // Bars to fixed points.
    const std::int64_t *stay_node, *stay_law;                // (stays,)
    const double *stay_end, *stay_length, *stay_stiffness;   // (stays, 3), (stays,), (stays,)
    // Linear spring-dampers to the ground.
    const std::int64_t* ground_node;                                // (grounds,)
    const double *ground_stiffness, *ground_damping, *ground_free;  // (grounds, 3, 3) twice, (grounds, 3)
    // Stretches of wires that pantographs may touch: first and last node, contact stiffness.
    const std::int64_t* path_nodes;  // (paths, 2)
    const double* path_stiffness;    // (paths,)
    double damping_mass, damping_stiffness;
    // Added per square of the time step (numerics/motion/dispersion.py); null: nothing.
    const double *stiffening_bending, *stiffening_load;  // (nodes - 1,), (nodes, 6)
};

// Parts of a line that threads can work on side by side, if it is long enough (line/layout.hpp). More
// than two were not needed: each end of a part costs some rows twice.
inline constexpr int kMostParts = 2;

// Time integration (theory: numerics/newmark.py) and when an iteration stops.
struct Scheme {
    double alpha, beta, gamma;
    double time_step;  // the step that others are compared with
    double tolerance;
    int iterations;
    bool full_newton;
    int threads;  // that may take part, the calling one included; the numbers do not depend on them
    bool awaits_helpers;  // for tests, see Team
};

// One pantograph as a chain of stages, head first (numerics/pantograph.py).
struct PantographData {
    int stages;
    const double* mass;                  // (stages,)
    const double *stiffness, *damping;  // (stages, stages)
    double start_height;
    double reach[2];  // lateral positions between which the head can touch a wire
};

// A number of equal steps: what is known in advance and where the histories go.
struct Chunk {
    int steps;
    double time_step;
    bool until_crossing;  // stop before a step in which a pantograph leaves or meets the wires
    const bool* on_line;  // (steps, pantographs)
    // Where the plane of contact stands: a point of it, its normal (along the track), and the
    // direction in which the head rises.
    const double* frame;  // (steps, pantographs, 3, 3)
    const double* rise;   // of the running surface above the wire, (steps, pantographs, paths)
    const double *before, *after;  // external forces at both ends of a step, (steps, all stages)
    int observed;
    const std::int64_t* observed_dofs;
    // Of every pair of pantograph and path; NaN where they cannot meet.
    double *force, *gap, *height;  // (steps, pantographs, paths)
    double* stages;                // (steps, all stages)
    double* tie_force;             // (steps, ties)
    double* coordinates;           // (steps, observed)
    double* refused_gap;           // (pantographs,)
};

enum class Outcome { running, not_converged, singular, not_finite, off_the_line, crossing };

struct Counters {
    std::int64_t steps, iterations, refactorisations, full_newton_steps;
    std::int64_t local_iterations;  // in some rows alone
    std::int64_t local_rows;        // rows of local iterations where residuals were formed
    std::int64_t solved_rows;       // rows of local iterations that were solved for
    std::int64_t helped_parts;      // parts of the work that were done by other threads
    double overlooked;              // largest increment where none above the tolerance was expected [m]
};

// Wall time spent in the parts of the work so far [s].
struct Timings {
    double elimination, contacts, substitution, records, total;
};

double seconds();  // a clock; defined in processor.cpp

class Engine {
public:
    virtual ~Engine();  // defined in module.cpp, so that no kernel carries the only copy
    virtual void add_pantograph(const PantographData& pantograph) = 0;
    // Take the steps of a chunk; `done` tells how many succeeded. A step that fails or is refused
    // leaves the state as it was.
    virtual Outcome advance(const Chunk& chunk, int& done) = 0;
    // Start from a state that need not be in balance; false when the mass matrix is singular.
    virtual bool start_from(const double* q, const double* v) = 0;
    virtual void coordinates(double* out) const = 0;  // (nodes, 6)
    virtual void velocities(double* out) const = 0;
    // The complete state of wires and pantographs as numbers.
    virtual std::size_t state_size() const = 0;
    virtual void save(double* out) const = 0;
    virtual void restore(const double* in) = 0;
    virtual Counters counters() const = 0;
    virtual int threads() const = 0;  // that take part: one where the line has one part
    virtual Timings timings() const = 0;
};

// The kernels of one instruction set.
struct Backend {
    const char* name;
    int lanes;
    Engine* (*make_engine)(const LineData& line, const Scheme& scheme);
    // Element arrays have the element last: e and out are (4, 3, n) and (4, 3, 4, 3, n).
    void (*cable_force)(int n, const double* e, const double* length, const double* axial,
                        const double* bending, double* out);
    void (*cable_tangent)(int n, const double* e, const double* length, const double* axial,
                          const double* bending, double* out);
};

}  // namespace tautwire
