// What the native core is given and what it offers, the same for every instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tautwire {

// The line; wire 0 is the contact wire, wire 1 the messenger wire. Arrays are only read while an
// engine is made.
struct LineData {
    int stations, droppers, arms, springs;
    const double *length, *axial_stiffness, *bending_stiffness, *mass;  // (2, stations - 1)
    const double* node_mass;                                            // (stations, 2)
    const double *load, *position;                                      // (stations, 2, 6)
    const bool* fixed;                                                  // (stations, 2, 6)
    const std::int64_t* dropper_station;
    const double *dropper_length, *dropper_stiffness;
    const std::int64_t* arm_station;
    const double *arm_end, *arm_length, *arm_stiffness;  // (arms, 3), (arms,), (arms,)
    const std::int64_t* spring_dof;
    const double *spring_stiffness, *spring_damping, *spring_free;
    double damping_mass, damping_stiffness;
    // Added per square of the time step (numerics/dispersion.py); null: nothing.
    const double *stiffening_bending, *stiffening_load;  // (2, stations - 1), (stations, 2, 6)
};

// Time integration (theory: numerics/newmark.py) and when an iteration stops.
struct Scheme {
    double alpha, beta, gamma;
    double time_step;  // the step that others are compared with
    double contact_stiffness, tolerance;
    int iterations;
    bool full_newton;
};

// One pantograph as a chain of stages, head first (numerics/pantograph.py).
struct PantographData {
    int stages;
    const double* mass;                  // (stages,)
    const double *stiffness, *damping;  // (stages, stages)
    double start_height;
};

// A number of equal steps: what is known in advance and where the histories go.
struct Chunk {
    int steps;
    double time_step;
    bool until_crossing;           // stop before a step in which a contact opens or closes
    const bool* on_line;           // (steps, pantographs)
    const double *position, *rise;  // (steps, pantographs)
    const double *before, *after;  // external forces at both ends of a step, (steps, all stages)
    int observed;
    const std::int64_t* observed_dofs;
    double *force, *gap, *height;  // (steps, pantographs)
    double* stages;                // (steps, all stages)
    double* dropper_force;         // (steps, droppers)
    double* coordinates;           // (steps, observed)
    double* refused_gap;           // (pantographs,)
};

enum class Outcome { running, not_converged, singular, not_finite, off_the_line, crossing };

struct Counters {
    std::int64_t steps, iterations, refactorisations, full_newton_steps;
    std::int64_t local_iterations;  // around the contacts alone
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
    virtual void coordinates(double* out) const = 0;  // (stations, 2, 6)
    virtual void velocities(double* out) const = 0;
    // The complete state of wires and pantographs as numbers.
    virtual std::size_t state_size() const = 0;
    virtual void save(double* out) const = 0;
    virtual void restore(const double* in) = 0;
    virtual Counters counters() const = 0;
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
