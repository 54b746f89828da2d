// Python bindings, and the choice of the instruction set.
#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

#include <cstring>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "arguments.hpp"
#include "engine.hpp"
#include "processor.hpp"

namespace tautwire {

Engine::~Engine() = default;

namespace {

const Backend* chosen = nullptr;

// The engine and what is needed to check the arrays passed to it.
class Stepper {
public:
    Stepper(const nb::dict& line, const nb::dict& scheme);

    void add_pantograph(nb::object mass, nb::object stiffness, nb::object damping,
                        double start_height, nb::object reach) {
        Arguments given;
        const std::size_t n = nb::len(mass);
        if (n == 0) throw nb::value_error("mass is empty; a pantograph has at least one stage");
        const double* lateral = given.array<const double>(reach, 2, "reach");
        engine_->add_pantograph({static_cast<int>(n), given.array<const double>(mass, n, "mass"),
                                 given.array<const double>(stiffness, n * n, "stiffness"),
                                 given.array<const double>(damping, n * n, "damping"), start_height,
                                 {lateral[0], lateral[1]}});
        ++pantographs_;
        stages_ += n;
    }

    // Take steps; fill the history arrays; return how many succeeded and the outcome as a number.
    std::tuple<int, int> advance(const nb::dict& known, const nb::dict& histories);

    bool start_from(nb::object q, nb::object v) {
        Arguments given;
        const double* at = given.array<const double>(q, 6 * nodes_, "q");
        return engine_->start_from(at, given.array<const double>(v, 6 * nodes_, "v"));
    }
    void coordinates(nb::object out) const {
        engine_->coordinates(Arguments().array<double>(out, 6 * nodes_, "out"));
    }
    void velocities(nb::object out) const {
        engine_->velocities(Arguments().array<double>(out, 6 * nodes_, "out"));
    }
    std::tuple<double, double, double, double, double> timings() const {
        const Timings t = engine_->timings();
        return {t.elimination, t.contacts, t.substitution, t.records, t.total};
    }
    std::size_t state_size() const { return engine_->state_size(); }
    void save(nb::object out) const {
        engine_->save(Arguments().array<double>(out, state_size(), "out"));
    }
    void restore(nb::object state) {
        engine_->restore(Arguments().array<const double>(state, state_size(), "state"));
    }
    std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t,
               std::int64_t, std::int64_t, double>
    counters() const {
        const Counters c = engine_->counters();
        return {c.steps, c.iterations, c.refactorisations, c.full_newton_steps,
                c.local_iterations, c.local_rows, c.solved_rows, c.helped_parts, c.overlooked};
    }
    int threads() const { return engine_->threads(); }

private:
    std::unique_ptr<Engine> engine_;
    std::size_t nodes_ = 0, ties_ = 0, paths_ = 0, pantographs_ = 0, stages_ = 0;
};

Stepper::Stepper(const nb::dict& line, const nb::dict& scheme) {
    Arguments given;
    const auto numbers = [&](const char* name, std::size_t size) {
        return given.entry<const double>(line, name, size);
    };
    const auto indices = [&](const char* name, std::size_t size, std::size_t count) {
        const std::int64_t* found = given.entry<const std::int64_t>(line, name, size);
        check_indices(found, size, static_cast<std::int64_t>(count), name);
        return found;
    };
    const auto length = [&line](const char* name) { return Arguments::length(line, name); };
    nodes_ = length("node_mass");
    ties_ = length("tie_length");
    paths_ = length("path_stiffness");
    if (nodes_ < 2) throw nb::value_error("node_mass: a line has at least two nodes");
    const std::size_t clamps = length("clamp_stiffness"), stays = length("stay_length");
    const std::size_t grounds = length("ground_node"), cables = nodes_ - 1, dofs = 6 * nodes_;
    LineData data;
    data.nodes = static_cast<int>(nodes_);
    data.ties = static_cast<int>(ties_);
    data.clamps = static_cast<int>(clamps);
    data.stays = static_cast<int>(stays);
    data.grounds = static_cast<int>(grounds);
    data.paths = static_cast<int>(paths_);
    data.length = numbers("length", cables);
    data.axial_stiffness = numbers("axial_stiffness", cables);
    data.bending_stiffness = numbers("bending_stiffness", cables);
    data.mass = numbers("mass", cables);
    data.node_mass = numbers("node_mass", nodes_);
    data.load = numbers("load", dofs);
    data.position = numbers("position", dofs);
    data.fixed = given.entry<const bool>(line, "fixed", dofs);
    data.rank = indices("rank", nodes_, nodes_);
    data.tie_nodes = indices("tie_nodes", 2 * ties_, nodes_);
    data.tie_law = indices("tie_law", ties_, kLaws);
    data.tie_length = numbers("tie_length", ties_);
    data.tie_stiffness = numbers("tie_stiffness", ties_);
    data.clamp_nodes = indices("clamp_nodes", 2 * clamps, nodes_);
    data.clamp_stiffness = numbers("clamp_stiffness", clamps);
    data.clamp_offset = numbers("clamp_offset", 3 * clamps);
    data.stay_node = indices("stay_node", stays, nodes_);
    data.stay_law = indices("stay_law", stays, kLaws);
    data.stay_end = numbers("stay_end", 3 * stays);
    data.stay_length = numbers("stay_length", stays);
    data.stay_stiffness = numbers("stay_stiffness", stays);
    data.ground_node = indices("ground_node", grounds, nodes_);
    data.ground_stiffness = numbers("ground_stiffness", 9 * grounds);
    data.ground_damping = numbers("ground_damping", 9 * grounds);
    data.ground_free = numbers("ground_free", 3 * grounds);
    data.path_nodes = indices("path_nodes", 2 * paths_, nodes_);
    data.path_stiffness = numbers("path_stiffness", paths_);
    for (std::size_t i = 0; i < paths_; ++i)
        if (data.path_nodes[2 * i] >= data.path_nodes[2 * i + 1])
            throw nb::value_error("path_nodes: a path has two nodes at least, from left to right");
    const bool stiffened = line.contains("stiffening_bending");
    data.stiffening_bending = stiffened ? numbers("stiffening_bending", cables) : nullptr;
    data.stiffening_load = stiffened ? numbers("stiffening_load", dofs) : nullptr;
    data.damping_mass = Arguments::value<double>(line, "damping_mass");
    data.damping_stiffness = Arguments::value<double>(line, "damping_stiffness");
    const int threads = Arguments::value<int>(scheme, "threads");
    if (threads < 1 || threads > kMostParts)
        throw nb::value_error(("threads must be from 1 to " + std::to_string(kMostParts)).c_str());
    const bool awaits_helpers =
        scheme.contains("awaits_helpers") && Arguments::value<bool>(scheme, "awaits_helpers");
    const auto number = [&scheme](const char* name) { return Arguments::value<double>(scheme, name); };
    engine_.reset(chosen->make_engine(
        data, Scheme{number("alpha"), number("beta"), number("gamma"),
                     Arguments::positive(scheme, "time_step"), number("tolerance"),
                     Arguments::value<int>(scheme, "iterations"),
                     Arguments::value<bool>(scheme, "full_newton"), threads, awaits_helpers}));
}

std::tuple<int, int> Stepper::advance(const nb::dict& known, const nb::dict& histories) {
    Arguments given;
    const std::size_t steps = Arguments::length(known, "on_line"), pairs = pantographs_ * paths_;
    const std::size_t observed = Arguments::length(known, "observed");
    const auto in = [&](const char* name, std::size_t width) {
        return given.entry<const double>(known, name, steps * width);
    };
    const auto out = [&](const char* name, std::size_t width) {
        return given.entry<double>(histories, name, steps * width);
    };
    Chunk chunk;
    chunk.steps = static_cast<int>(steps);
    chunk.time_step = Arguments::positive(known, "time_step");
    chunk.until_crossing = Arguments::value<bool>(known, "until_crossing");
    chunk.on_line = given.entry<const bool>(known, "on_line", steps * pantographs_);
    chunk.frame = in("frame", 9 * pantographs_);
    chunk.rise = in("rise", pairs);
    chunk.before = in("before", stages_);
    chunk.after = in("after", stages_);
    chunk.observed = static_cast<int>(observed);
    chunk.observed_dofs = given.entry<const std::int64_t>(known, "observed", observed);
    check_indices(chunk.observed_dofs, observed, static_cast<std::int64_t>(6 * nodes_), "observed");
    chunk.force = out("contact_force", pairs);
    chunk.gap = out("gap", pairs);
    chunk.height = out("wire_height", pairs);
    chunk.stages = out("stages", stages_);
    chunk.tie_force = out("dropper_force", ties_);
    chunk.coordinates = out("observed", observed);
    chunk.refused_gap = given.entry<double>(histories, "refused_gap", pantographs_);
    int done = 0;
    Outcome outcome;
    {
        nb::gil_scoped_release release;
        outcome = engine_->advance(chunk, done);
    }
    return {done, static_cast<int>(outcome)};
}

using CableKernel = void (*)(int, const double*, const double*, const double*, const double*, double*);

// Evaluate `factor` numbers per element of (4, 3, n) coordinates.
void run_cables(CableKernel kernel, std::size_t factor, nb::object e, nb::object length,
                nb::object axial, nb::object bending, nb::object out) {
    Arguments given;
    const std::size_t n = nb::len(length);
    const auto in = [&](nb::handle value, std::size_t size, const char* name) {
        return given.array<const double>(value, size, name);
    };
    kernel(static_cast<int>(n), in(e, 12 * n, "e"), in(length, n, "length"),
           in(axial, n, "axial_stiffness"), in(bending, n, "bending_stiffness"),
           given.array<double>(out, factor * n, "out"));
}

nb::object names_of(const std::vector<const Backend*>& backends) {
    nb::list names;
    for (const Backend* backend : backends) names.append(backend->name);
    return nb::tuple(names);
}

// Make everything that follows use the kernels of an instruction set.
void use(const char* name) {
    for (const Backend* backend : runnable_backends())
        if (!std::strcmp(backend->name, name)) {
            chosen = backend;
            return;
        }
    throw nb::value_error((std::string("no kernels named '") + name + "' run here").c_str());
}

}  // namespace

NB_MODULE(_core, m) {
    chosen = runnable_backends().front();
    m.doc() = "Compiled kernels of tautwire; use them through tautwire.numerics.motion.backend.";
    m.attr("built") = names_of(built_backends());
    m.attr("most_threads") = kMostParts;
    m.attr("runnable") = names_of(runnable_backends());
    m.def("instruction_set", [] { return chosen->name; });
    m.def("use", &use, nb::arg("name"));
    m.def("cable_force", [](nb::object e, nb::object length, nb::object axial, nb::object bending,
                            nb::object out) {
        run_cables(chosen->cable_force, 12, e, length, axial, bending, out);
    });
    m.def("cable_tangent", [](nb::object e, nb::object length, nb::object axial, nb::object bending,
                              nb::object out) {
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
        .def("counters", &Stepper::counters)
        .def("threads", &Stepper::threads);
}

}  // namespace tautwire
