// Python bindings, and the choice of the instruction set at import.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine.hpp"
#include "processor.hpp"

namespace nb = nanobind;

namespace tautwire {

Engine::~Engine() = default;

namespace {

template <class T>
using In = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;
template <class T>
using Out = nb::ndarray<T, nb::c_contig, nb::device::cpu>;

// Data of an array that must have `size` entries.
template <class A>
auto* checked(const A& array, std::size_t size, const char* name) {
    if (array.size() != size)
        throw std::invalid_argument(std::string(name) + " has " + std::to_string(array.size()) +
                                    " entries, expected " + std::to_string(size));
    return array.data();
}

const Backend* chosen = nullptr;

// The engine and what is needed to check the arrays passed to it.
class Stepper {
public:
    Stepper(const nb::dict& line, const nb::dict& scheme);

    void add_pantograph(const In<double>& mass, const In<double>& stiffness,
                        const In<double>& damping, double start_height, const In<double>& reach) {
        const std::size_t n = mass.size();
        if (n == 0) throw std::invalid_argument("a pantograph has at least one stage");
        const double* lateral = checked(reach, 2, "reach");
        engine_->add_pantograph({static_cast<int>(n), mass.data(),
                                 checked(stiffness, n * n, "stiffness"),
                                 checked(damping, n * n, "damping"), start_height,
                                 {lateral[0], lateral[1]}});
        ++pantographs_;
        stages_ += n;
    }

    // Take steps; fill the history arrays; return how many succeeded and the outcome as a number.
    std::tuple<int, int> advance(const nb::dict& known, const nb::dict& histories);

    bool start_from(const In<double>& q, const In<double>& v) {
        return engine_->start_from(checked(q, 6 * nodes_, "q"), checked(v, 6 * nodes_, "v"));
    }
    void coordinates(const Out<double>& out) const {
        engine_->coordinates(checked(out, 6 * nodes_, "out"));
    }
    void velocities(const Out<double>& out) const {
        engine_->velocities(checked(out, 6 * nodes_, "out"));
    }
    std::tuple<double, double, double, double, double> timings() const {
        const Timings t = engine_->timings();
        return {t.elimination, t.contacts, t.substitution, t.records, t.total};
    }
    std::size_t state_size() const { return engine_->state_size(); }
    void save(const Out<double>& out) const { engine_->save(checked(out, state_size(), "out")); }
    void restore(const In<double>& in) { engine_->restore(checked(in, state_size(), "state")); }
    std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t> counters()
        const {
        const Counters c = engine_->counters();
        return {c.steps, c.iterations, c.refactorisations, c.full_newton_steps,
                c.local_iterations};
    }

private:
    std::unique_ptr<Engine> engine_;
    std::size_t nodes_ = 0, ties_ = 0, paths_ = 0, pantographs_ = 0, stages_ = 0;
};

template <class T>
auto* entry(const nb::dict& arrays, const char* name, std::size_t size) {
    return checked(nb::cast<In<T>>(arrays[name]), size, name);
}

// Check that an index array holds numbers from 0 to below `count`.
const std::int64_t* indices(const nb::dict& arrays, const char* name, std::size_t size, int count) {
    const std::int64_t* values = entry<std::int64_t>(arrays, name, size);
    for (std::size_t i = 0; i < size; ++i)
        if (values[i] < 0 || values[i] >= count)
            throw std::invalid_argument(std::string(name) + " is outside the line");
    return values;
}

Stepper::Stepper(const nb::dict& line, const nb::dict& scheme) {
    const auto length = [&line](const char* name) {
        return static_cast<int>(nb::len(nb::object(line[name])));
    };
    LineData data;
    data.nodes = length("node_mass");
    data.ties = length("tie_length");
    data.clamps = length("clamp_stiffness");
    data.stays = length("stay_length");
    data.grounds = length("ground_node");
    data.paths = length("path_stiffness");
    if (data.nodes < 2) throw std::invalid_argument("a line has at least two nodes");
    nodes_ = data.nodes;
    ties_ = data.ties;
    paths_ = data.paths;
    const auto number_of = [&line](const char* name, int count) {
        return entry<double>(line, name, count);
    };
    const auto nodes = [&](const char* name, int count) {
        return indices(line, name, count, data.nodes);
    };
    const int cables = data.nodes - 1, dofs = 6 * data.nodes;
    data.length = number_of("length", cables);
    data.axial_stiffness = number_of("axial_stiffness", cables);
    data.bending_stiffness = number_of("bending_stiffness", cables);
    data.mass = number_of("mass", cables);
    data.node_mass = number_of("node_mass", data.nodes);
    data.load = number_of("load", dofs);
    data.position = number_of("position", dofs);
    data.fixed = entry<bool>(line, "fixed", dofs);
    data.rank = nodes("rank", data.nodes);
    data.tie_nodes = nodes("tie_nodes", 2 * data.ties);
    data.tie_law = indices(line, "tie_law", data.ties, 3);
    data.tie_length = number_of("tie_length", data.ties);
    data.tie_stiffness = number_of("tie_stiffness", data.ties);
    data.clamp_nodes = nodes("clamp_nodes", 2 * data.clamps);
    data.clamp_stiffness = number_of("clamp_stiffness", data.clamps);
    data.clamp_offset = number_of("clamp_offset", 3 * data.clamps);
    data.stay_node = nodes("stay_node", data.stays);
    data.stay_law = indices(line, "stay_law", data.stays, 3);
    data.stay_end = number_of("stay_end", 3 * data.stays);
    data.stay_length = number_of("stay_length", data.stays);
    data.stay_stiffness = number_of("stay_stiffness", data.stays);
    data.ground_node = nodes("ground_node", data.grounds);
    data.ground_stiffness = number_of("ground_stiffness", 9 * data.grounds);
    data.ground_damping = number_of("ground_damping", 9 * data.grounds);
    data.ground_free = number_of("ground_free", 3 * data.grounds);
    data.path_nodes = nodes("path_nodes", 2 * data.paths);
    data.path_stiffness = number_of("path_stiffness", data.paths);
    for (int i = 0; i < data.paths; ++i)
        if (data.path_nodes[2 * i] >= data.path_nodes[2 * i + 1])
            throw std::invalid_argument("a path has at least two nodes, from left to right");
    const bool stiffened = line.contains("stiffening_bending");
    data.stiffening_bending = stiffened ? number_of("stiffening_bending", cables) : nullptr;
    data.stiffening_load = stiffened ? number_of("stiffening_load", dofs) : nullptr;
    data.damping_mass = nb::cast<double>(line["damping_mass"]);
    data.damping_stiffness = nb::cast<double>(line["damping_stiffness"]);
    const auto number = [&scheme](const char* name) { return nb::cast<double>(scheme[name]); };
    engine_.reset(chosen->make_engine(
        data, Scheme{number("alpha"), number("beta"), number("gamma"), number("time_step"),
                     number("tolerance"),
                     nb::cast<int>(scheme["iterations"]), nb::cast<bool>(scheme["full_newton"])}));
}

std::tuple<int, int> Stepper::advance(const nb::dict& known, const nb::dict& histories) {
    const auto observed = nb::cast<In<std::int64_t>>(known["observed"]);
    const std::size_t steps = nb::len(nb::object(known["on_line"])), pairs = pantographs_ * paths_;
    const auto out = [&histories](const char* name, std::size_t size) {
        return checked(nb::cast<Out<double>>(histories[name]), size, name);
    };
    for (std::size_t i = 0; i < observed.size(); ++i)
        if (observed.data()[i] < 0 || observed.data()[i] >= static_cast<std::int64_t>(6 * nodes_))
            throw std::invalid_argument("an observed degree of freedom is outside the line");
    Chunk chunk;
    chunk.steps = static_cast<int>(steps);
    chunk.time_step = nb::cast<double>(known["time_step"]);
    chunk.until_crossing = nb::cast<bool>(known["until_crossing"]);
    if (!(chunk.time_step > 0.0)) throw std::invalid_argument("time_step must be positive");
    chunk.on_line = entry<bool>(known, "on_line", steps * pantographs_);
    chunk.frame = entry<double>(known, "frame", steps * pantographs_ * 9);
    chunk.rise = entry<double>(known, "rise", steps * pairs);
    chunk.before = entry<double>(known, "before", steps * stages_);
    chunk.after = entry<double>(known, "after", steps * stages_);
    chunk.observed = static_cast<int>(observed.size());
    chunk.observed_dofs = observed.data();
    chunk.force = out("contact_force", steps * pairs);
    chunk.gap = out("gap", steps * pairs);
    chunk.height = out("wire_height", steps * pairs);
    chunk.stages = out("stages", steps * stages_);
    chunk.tie_force = out("dropper_force", steps * ties_);
    chunk.coordinates = out("observed", steps * observed.size());
    chunk.refused_gap = out("refused_gap", pantographs_);
    int done = 0;
    Outcome outcome;
    {
        nb::gil_scoped_release release;
        outcome = engine_->advance(chunk, done);
    }
    return {done, static_cast<int>(outcome)};
}

using CableKernel = void (*)(int, const double*, const double*, const double*, const double*, double*);

void run_cables(CableKernel kernel, std::size_t factor, const In<double>& e, const In<double>& length,
                const In<double>& axial, const In<double>& bending, const Out<double>& out) {
    const std::size_t n = length.size();
    kernel(static_cast<int>(n), checked(e, 12 * n, "e"), length.data(),
           checked(axial, n, "axial_stiffness"), checked(bending, n, "bending_stiffness"),
           checked(out, factor * n, "out"));
}

}  // namespace

NB_MODULE(_core, m) {
    chosen = choose_backend(std::getenv("TAUTWIRE_SIMD"));
    m.doc() = "Compiled kernels of tautwire; use them through tautwire.numerics.motion.backend.";
    m.attr("instruction_set") = chosen->name;
    m.attr("lanes") = chosen->lanes;
    m.def("cable_force", [](const In<double>& e, const In<double>& length, const In<double>& axial,
                            const In<double>& bending, const Out<double>& out) {
        run_cables(chosen->cable_force, 12, e, length, axial, bending, out);
    });
    m.def("cable_tangent", [](const In<double>& e, const In<double>& length, const In<double>& axial,
                              const In<double>& bending, const Out<double>& out) {
        run_cables(chosen->cable_tangent, 144, e, length, axial, bending, out);
    });
    nb::class_<Stepper>(m, "Stepper")
        .def(nb::init<const nb::dict&, const nb::dict&>(), nb::arg("line"), nb::arg("scheme"))
        .def("add_pantograph", &Stepper::add_pantograph, nb::arg("mass"), nb::arg("stiffness"),
             nb::arg("damping"), nb::arg("start_height"), nb::arg("reach"))
        .def("advance", &Stepper::advance, nb::arg("known"), nb::arg("histories"))
        .def("start_from", &Stepper::start_from, nb::arg("q"), nb::arg("v"))
        .def("coordinates", &Stepper::coordinates, nb::arg("out"))
        .def("velocities", &Stepper::velocities, nb::arg("out"))
        .def("state_size", &Stepper::state_size)
        .def("save", &Stepper::save, nb::arg("out"))
        .def("restore", &Stepper::restore, nb::arg("state"))
        .def("timings", &Stepper::timings)
        .def("counters", &Stepper::counters);
}

}  // namespace tautwire
