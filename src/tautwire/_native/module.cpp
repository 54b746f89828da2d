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
                        const In<double>& damping, double start_height) {
        const std::size_t n = mass.size();
        const PantographData data{static_cast<int>(n), mass.data(),
                                  checked(stiffness, n * n, "stiffness"),
                                  checked(damping, n * n, "damping"), start_height};
        if (n == 0 || !engine_->add_pantograph(data))
            throw std::invalid_argument("too many pantographs, or one without stages");
        ++pantographs_;
        stages_ += n;
    }

    // Take steps; fill the history arrays; return how many succeeded and the outcome as a number.
    std::tuple<int, int> advance(const nb::dict& known, const nb::dict& histories);

    bool start_from(const In<double>& q, const In<double>& v) {
        return engine_->start_from(checked(q, 12 * stations_, "q"), checked(v, 12 * stations_, "v"));
    }
    void coordinates(const Out<double>& out) const {
        engine_->coordinates(checked(out, 12 * stations_, "out"));
    }
    void velocities(const Out<double>& out) const {
        engine_->velocities(checked(out, 12 * stations_, "out"));
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
    std::size_t stations_ = 0, droppers_ = 0, pantographs_ = 0, stages_ = 0;
};

template <class T>
auto* entry(const nb::dict& arrays, const char* name, std::size_t size) {
    return checked(nb::cast<In<T>>(arrays[name]), size, name);
}

Stepper::Stepper(const nb::dict& line, const nb::dict& scheme) {
    const auto length = [&line](const char* name) { return nb::len(nb::object(line[name])); };
    stations_ = length("node_mass");
    droppers_ = length("dropper_station");
    const std::size_t arms = length("arm_station"), springs = length("spring_dof");
    const std::size_t cables = 2 * (stations_ - 1), dofs = 12 * stations_;
    if (stations_ < 2) throw std::invalid_argument("a line has at least two stations");
    LineData data;
    data.stations = static_cast<int>(stations_);
    data.droppers = static_cast<int>(droppers_);
    data.arms = static_cast<int>(arms);
    data.springs = static_cast<int>(springs);
    data.length = entry<double>(line, "length", cables);
    data.axial_stiffness = entry<double>(line, "axial_stiffness", cables);
    data.bending_stiffness = entry<double>(line, "bending_stiffness", cables);
    data.mass = entry<double>(line, "mass", cables);
    data.node_mass = entry<double>(line, "node_mass", 2 * stations_);
    data.load = entry<double>(line, "load", dofs);
    data.position = entry<double>(line, "position", dofs);
    data.fixed = entry<bool>(line, "fixed", dofs);
    data.dropper_station = entry<std::int64_t>(line, "dropper_station", droppers_);
    data.dropper_length = entry<double>(line, "dropper_length", droppers_);
    data.dropper_stiffness = entry<double>(line, "dropper_stiffness", droppers_);
    data.arm_station = entry<std::int64_t>(line, "arm_station", arms);
    data.arm_end = entry<double>(line, "arm_end", 3 * arms);
    data.arm_length = entry<double>(line, "arm_length", arms);
    data.arm_stiffness = entry<double>(line, "arm_stiffness", arms);
    data.spring_dof = entry<std::int64_t>(line, "spring_dof", springs);
    data.spring_stiffness = entry<double>(line, "spring_stiffness", springs);
    data.spring_damping = entry<double>(line, "spring_damping", springs);
    data.spring_free = entry<double>(line, "spring_free", springs);
    const bool stiffened = line.contains("stiffening_bending");
    data.stiffening_bending = stiffened ? entry<double>(line, "stiffening_bending", cables) : nullptr;
    data.stiffening_load = stiffened ? entry<double>(line, "stiffening_load", dofs) : nullptr;
    data.damping_mass = nb::cast<double>(line["damping_mass"]);
    data.damping_stiffness = nb::cast<double>(line["damping_stiffness"]);
    for (std::size_t i = 0; i < droppers_; ++i)
        if (data.dropper_station[i] < 0 || data.dropper_station[i] >= data.stations)
            throw std::invalid_argument("dropper_station is outside the line");
    for (std::size_t i = 0; i < arms; ++i)
        if (data.arm_station[i] < 0 || data.arm_station[i] >= data.stations)
            throw std::invalid_argument("arm_station is outside the line");
    for (std::size_t i = 0; i < springs; ++i)
        if (data.spring_dof[i] < 0 || data.spring_dof[i] >= 12 * data.stations)
            throw std::invalid_argument("spring_dof is outside the line");
    const auto number = [&scheme](const char* name) { return nb::cast<double>(scheme[name]); };
    engine_.reset(chosen->make_engine(
        data, Scheme{number("alpha"), number("beta"), number("gamma"), number("time_step"),
                     number("contact_stiffness"), number("tolerance"),
                     nb::cast<int>(scheme["iterations"]), nb::cast<bool>(scheme["full_newton"])}));
}

std::tuple<int, int> Stepper::advance(const nb::dict& known, const nb::dict& histories) {
    const auto observed = nb::cast<In<std::int64_t>>(known["observed"]);
    const std::size_t steps = nb::len(nb::object(known["position"]));
    const auto out = [&histories](const char* name, std::size_t size) {
        return checked(nb::cast<Out<double>>(histories[name]), size, name);
    };
    for (std::size_t i = 0; i < observed.size(); ++i)
        if (observed.data()[i] < 0 || observed.data()[i] >= static_cast<std::int64_t>(12 * stations_))
            throw std::invalid_argument("an observed degree of freedom is outside the line");
    Chunk chunk;
    chunk.steps = static_cast<int>(steps);
    chunk.time_step = nb::cast<double>(known["time_step"]);
    chunk.until_crossing = nb::cast<bool>(known["until_crossing"]);
    if (!(chunk.time_step > 0.0)) throw std::invalid_argument("time_step must be positive");
    chunk.on_line = entry<bool>(known, "on_line", steps * pantographs_);
    chunk.position = entry<double>(known, "position", steps * pantographs_);
    chunk.rise = entry<double>(known, "rise", steps * pantographs_);
    chunk.before = entry<double>(known, "before", steps * stages_);
    chunk.after = entry<double>(known, "after", steps * stages_);
    chunk.observed = static_cast<int>(observed.size());
    chunk.observed_dofs = observed.data();
    chunk.force = out("contact_force", steps * pantographs_);
    chunk.gap = out("gap", steps * pantographs_);
    chunk.height = out("wire_height", steps * pantographs_);
    chunk.stages = out("stages", steps * stages_);
    chunk.dropper_force = out("dropper_force", steps * droppers_);
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
             nb::arg("damping"), nb::arg("start_height"))
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
