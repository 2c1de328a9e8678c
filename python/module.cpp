// SPDX-License-Identifier: MIT
// The module _cuboct. What users see, with its documentation, is the package around it: python/cuboct.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "cli/run/measure_run.h"
#include "cli/run/probe_lines.h"
#include "cli/run/summary.h"
#include "cli/run/templates.h"
#include "hw/engine/scene_engine.h"
#include "hw/plan/reach_cost.h"
#include "model/analysis/motion_warnings.h"
#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/module.h"
#include "model/base/process.h"
#include "model/base/spelling.h"
#include "model/base/standard_streams.h"
#include "model/base/utf8.h"
#include "model/config/config.h"
#include "model/rules/rounds_rule.h"
#include "model/trace/trace_head.h"
#include "python/explore.h"
#include "python/measures.h"
#include "python/runs.h"
#include "python/simulation.h"

namespace py = pybind11;

namespace cuboct::python {
namespace {

// Whatever takes long leaves the interpreter to other threads.
using Unlocked = py::call_guard<py::gil_scoped_release>;

// Copies: an engine's state moves on.
template <typename T>
py::array_t<T> array_of(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}
py::array_t<double> array_of(const std::vector<Vec3>& values) {
  py::array_t<double> array({static_cast<py::ssize_t>(values.size()), py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const Vec3& value : values) to = std::copy_n(value.data(), 3, to);
  return array;
}

py::object hex(uint64_t hash) { return py::str(fmt::format("{:016x}", hash)); }

py::dict dict_of(const Body& body) {
  py::dict state;
  state["positions"] = array_of(body.x);
  state["velocities"] = array_of(body.v);
  state["types"] = array_of(body.type);
  return state;
}

py::dict dict_of(const Fields& fields, size_t particles) {
  py::dict out;
  for (const auto& [name, values] : fields) {
    py::array flat = array_of(values);
    const size_t numbers = particles > 0 ? values.size() / particles : 1;
    if (numbers > 1) flat = flat.reshape({particles, numbers});
    out[name.c_str()] = flat;
  }
  return out;
}

// (values, units) by name, with the steps at which probes were read and those of energies, temperature and
// pressure.
py::tuple curves_of(const std::vector<Curve>& curves, double dt) {
  py::dict values, units;
  const auto add_steps = [&](const std::string& of, const std::vector<uint64_t>& steps) {
    std::vector<double> times;
    for (const uint64_t step : steps) times.push_back(static_cast<double>(step) * dt);
    const std::string step = of + "step", time = of + "time";
    values[step.c_str()] = array_of(steps), units[step.c_str()] = "1";
    values[time.c_str()] = array_of(times), units[time.c_str()] = "s";
  };
  add_steps("", curves.empty() ? std::vector<uint64_t>() : curves.front().step);
  for (const Curve& curve : curves) {
    if (curve.name == "energy.kinetic") add_steps("energy.", curve.step);
    values[curve.name.c_str()] = array_of(curve.value);
    units[curve.name.c_str()] = curve.unit;
  }
  return py::make_tuple(values, units);
}

py::object spans_of(const Trace& trace) {
  if (trace.cycles.empty()) return py::none();
  const auto nodes = static_cast<py::ssize_t>(trace.nodes);
  const auto phases = static_cast<py::ssize_t>(trace.phases());
  const auto steps = static_cast<py::ssize_t>(trace.cycles.size()) / (nodes * phases);
  static_assert(sizeof(PhaseSpan) == 2 * sizeof(uint64_t));
  py::array_t<uint64_t> array({steps, nodes, phases, py::ssize_t{2}});
  std::memcpy(array.mutable_data(), trace.cycles.data(), trace.cycles.size() * sizeof(PhaseSpan));
  return array;
}

py::dict dict_of(const WholeRun& run) {
  const Trace& trace = run.recorded.trace;
  py::dict out;
  out["engine"] = trace.engine;
  out["steps"] = trace.steps();
  out["dt"] = run.dt;
  out["seconds"] = trace.seconds;
  out["hash"] = trace.state_hash.empty() ? py::none() : hex(trace.state_hash.back());
  out["hashes"] = array_of(trace.state_hash);
  out["hash_every"] = trace.hash_every;
  out["plan_hash"] = hex(trace.plan_hash);
  const py::tuple curves = curves_of(trace.curves, run.dt);
  out["curves"] = curves[0], out["units"] = curves[1];
  py::list frames;
  for (const Kept& kept : run.kept) {
    py::dict frame = dict_of(kept.body);
    frame["fields"] = dict_of(kept.fields, kept.body.size());
    frame["step"] = kept.step;
    frames.append(frame);
  }
  out["frames"] = frames;
  out["cycles"] = spans_of(trace);
  py::dict counters;
  for (const auto& [name, value] : trace.counters) counters[name.c_str()] = value;
  out["counters"] = counters;
  py::list warnings;
  for (const Finding& finding : trace.findings) warnings.append(finding.text);
  out["warnings"] = warnings;
  out["stopped"] = trace.stop ? py::cast(trace.stop->text) : py::none();
  out["reached"] = trace.reached ? py::cast(reached_text(trace)) : py::none();
  out["summary"] = run.summary;
  out["_shown"] = run.shown;
  out["_matter"] = Matter{run.scene, stands_in_box(trace), velocities_late(trace, run.dt)};
  return out;
}

py::dict dict_of(const Comparison& comparison) {
  py::dict out;
  out["matched"] = comparison.matched;
  out["text"] = comparison.text;
  out["step"] = comparison.step;
  out["engines"] = comparison.engines;
  out["updates"] = comparison.updates;
  out["steps"] = comparison.steps;
  out["reached"] = comparison.reached;
  out["stopped"] = comparison.stopped;
  return out;
}

py::tuple tuple_of(const Table& table) {
  py::dict columns;
  for (const Column& column : table.columns)
    columns[column.name.c_str()] =
        column.texts.empty() ? py::object(array_of(column.numbers)) : py::cast(column.texts);
  return py::make_tuple(columns, table.left_out);
}

py::dict check(const Sources& sources) {
  py::gil_scoped_release unlocked;
  const Loaded loaded = load_plan(sources, true);
  const std::vector<StageName> stages = stages_of(sources);
  py::gil_scoped_acquire locked;
  const Scene& scene = loaded.scene;
  const Plan& plan = loaded.setup.plan;
  py::dict out;
  out["title"] = scene.title;
  out["particles"] = scene.body.size();
  out["dt"] = scene.rule.dt;
  out["dt_limit"] = scene.dt_limit > 0 ? py::cast(scene.dt_limit) : py::none();
  out["steps"] = scene.steps;
  const bool machine = scene.rule.rounds == nullptr;
  out["cells"] = machine ? py::cast(plan.lattice.size()) : py::none();
  out["cells_with_matter"] = machine ? py::cast(cells_with_matter(scene, plan)) : py::none();
  out["cell_edge"] = plan.rule.cell_edge;
  const CellEdges edges = plan.rule.edges();
  out["cell_edges"] = py::make_tuple(edges[0], edges[1], edges[2]);
  out["nodes"] = machine && plan.rule.cubic() ? py::cast(plan.nodes()) : py::none();
  out["plan_hash"] = hex(plan.hash);
  std::vector<std::string> warnings = motion_warnings(scene);
  warnings.insert(warnings.end(), plan.warnings.begin(), plan.warnings.end());
  if (std::string wide = machine ? reach_warning(scene, plan) : ""; !wide.empty())
    warnings.push_back(std::move(wide));
  const std::string reach = machine ? reach_line(scene, plan) : "";
  out["reach"] = reach.empty() ? py::none() : py::cast(reach);
  out["warnings"] = warnings;
  py::dict probes;
  for (const ProbeError& error : told_errors(scene, plan)) {
    py::list errors;
    for (const CurveError& curve : error.curves) {
      py::dict one;
      one["quantity"] = curve.quantity;
      one["error"] = curve.error;
      one["unit"] = curve.unit.empty() ? "1" : curve.unit;
      one["of_means"] = curve.of_means;
      errors.append(one);
    }
    py::dict told;
    told["text"] = error_text(scene, error);
    told["errors"] = errors;
    probes[error.probe.c_str()] = told;
  }
  out["probes"] = probes;
  out["engine"] = engine_for(scene);
  py::list names;
  for (const StageName& stage : stages) names.append(stage.name);
  out["stages"] = names;
  return out;
}

void one_of(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  if (std::ranges::find(names, name) != names.end()) return;
  const std::string near = did_you_mean(name, names);
  throw InputError(fmt::format("unknown {} '{}'", what, name),
                   near.empty() ? "one of " + list_of(names) : near);
}

// By the names of the command line's options.
EngineOptions options_of(const py::dict& given) {
  EngineOptions options;
  options.quiet = true;
  const auto take = [&](const char* name, auto& to) {
    if (!given.contains(name)) return false;
    to = given[name].cast<std::decay_t<decltype(to)>>();
    return true;
  };
  const auto count = [&](const char* name, int& to) {
    if (take(name, to) && to < 1) throw InputError(fmt::format("{} = {}: at least 1", name, to));
  };
  count("threads", options.threads);
  count("ranks", options.ranks);
  count("gpus", options.gpus);
  count("baud", options.baud);
  take("devices", options.devices);
  take("port", options.port);
  take("cycles", options.cycles);
  if (take("precision", options.precision))
    one_of("precision", options.precision, {"fixed", "float", "double"});
  if (take("integrator", options.integrator)) one_of("integrator", options.integrator, {"euler", "verlet"});
  if (take("rule_code", options.rule_code))
    one_of("rule_code", options.rule_code, {"automatic", "interpreted", "compiled"});
  options.hashes_given = take("hash_every", options.hash_every);
  if (options.hashes_given && options.hash_every < 1) throw InputError("hash_every = 0: at least 1");
  return options;
}

void raise(const char* type, const py::tuple& arguments, const py::object& places = py::none()) {
  const py::object kind = py::module_::import("cuboct._errors").attr(type);
  const py::object error = kind(*arguments);
  if (!places.is_none()) error.attr("_set_place")(places);
  PyErr_SetObject(kind.ptr(), error.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const InputError& error) {
    const InputError::Place* place = error.place();
    raise("InputError", py::make_tuple(bare_message(error), parts_of(error).hint),
          place ? py::object(py::make_tuple(place->file, place->line, place->column, place->excerpt))
                : py::object(py::none()));
  } catch (const Stopped& stopped) {
    raise("RunError", py::make_tuple(stopped.what(), stopped.advice, stopped.reason.step));
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

}  // namespace

PYBIND11_MODULE(_cuboct, module) {
  fill_standard_descriptors();  // the interpreter leaves those closed that were
  py::register_exception_translator(translate);
  module.attr("version") = program_version();

  py::class_<Sources>(module, "Sources")
      .def(py::init([](std::string scene, std::string scene_path, std::string arch, std::string arch_path) {
        return Sources{std::move(scene), std::move(scene_path), std::move(arch), std::move(arch_path)};
      }))
      .def("at",
           [](const Sources& sources, const std::string& stage, const std::string& from) {
             Sources other = sources;
             other.stage = stage;
             other.from = from;
             return other;
           })
      .def("read", &read_stage, Unlocked())
      .def("stages", [](const Sources& sources) {
        std::vector<std::pair<std::string, std::string>> names;  // of each part, and of its stage
        for (const StageName& one : stages_of(sources)) names.emplace_back(one.name, one.stage);
        return names;
      });

  py::class_<Shown, std::shared_ptr<Shown>>(module, "Shown").def("page", &page_of, Unlocked());

  py::class_<Simulation>(module, "Simulation")
      .def(py::init([](const Sources& sources, const std::string& engine, const py::dict& options,
                       std::optional<uint64_t> probe_every, bool anyway) {
        const EngineOptions choice = options_of(options);
        py::gil_scoped_release unlocked;
        return std::make_unique<Simulation>(sources, engine, choice, probe_every, anyway);
      }))
      .def("step", &Simulation::step, Unlocked())
      .def("run", &Simulation::run, Unlocked())
      .def("leave", &Simulation::leave, Unlocked())
      .def("shown", &Simulation::shown, Unlocked())
      .def("fields",
           [](Simulation& simulation) {
             Fields fields;
             {
               py::gil_scoped_release unlocked;
               fields = simulation.fields();
             }
             return dict_of(fields, simulation.particles());
           })
      .def("step_count", &Simulation::step_count, Unlocked())
      .def("state",
           [](Simulation& simulation) {
             Body body;
             {
               py::gil_scoped_release unlocked;
               body = simulation.body();
             }
             return dict_of(body);
           })
      .def("hash",
           [](Simulation& simulation) -> py::object {
             if (simulation.real()) return py::none();
             uint64_t hash = 0;
             {
               py::gil_scoped_release unlocked;
               hash = simulation.hash();
             }
             return hex(hash);
           })
      .def("plan_hash", [](Simulation& simulation) { return hex(simulation.plan_hash()); })
      .def("energies",
           [](Simulation& simulation) {
             EnergiesNow now;
             {
               py::gil_scoped_release unlocked;
               now = simulation.energies();
             }
             py::dict out;
             out["kinetic"] = now.of.kinetic, out["potential"] = now.of.potential;
             out["gravity"] = now.of.gravity, out["total"] = now.of.total();
             return py::make_tuple(out, now.temperature);
           })
      .def("curves",
           [](Simulation& simulation) {
             std::vector<Curve> curves;
             {
               py::gil_scoped_release unlocked;
               curves = simulation.curves();
             }
             return curves_of(curves, simulation.dt());
           })
      .def("set_velocity",
           [](Simulation& simulation, const std::string& constraint, const std::array<double, 3>& v) {
             py::gil_scoped_release unlocked;
             simulation.set_velocity(constraint, {v[0], v[1], v[2]});
           })
      .def("set_gravity",
           [](Simulation& simulation, const std::array<double, 3>& g) {
             py::gil_scoped_release unlocked;
             simulation.set_gravity({g[0], g[1], g[2]});
           })
      .def("picture",
           [](Simulation& simulation, const std::string& field, double limit, int width) {
             std::string png;
             {
               py::gil_scoped_release unlocked;
               png = simulation.picture(field, limit, width);
             }
             return py::bytes(png);
           })
      .def_property_readonly("engine", &Simulation::engine)
      .def_property_readonly("dt", &Simulation::dt)
      .def_property_readonly("particles", &Simulation::particles)
      .def_property_readonly("title", &Simulation::title)
      .def_property_readonly("type_names", &Simulation::type_names)
      .def_property_readonly("type_masses", &Simulation::type_masses);

  module.def("run", [](const Sources& sources, const std::string& engine, const py::dict& options,
                       std::optional<uint64_t> steps, std::optional<uint64_t> keep_every, bool anyway,
                       const std::string& leave) {
    const RunAsked asked{engine, options_of(options), steps, keep_every, anyway, leave};
    WholeRun result;
    {
      py::gil_scoped_release unlocked;
      result = run(sources, asked);
    }
    return dict_of(result);
  });
  module.def("crosscheck",
             [](const Sources& sources, const std::vector<std::string>& engines, const py::dict& options,
                std::optional<uint64_t> steps, const std::string& leave) {
               const EngineOptions choice = options_of(options);
               Comparison result;
               {
                 py::gil_scoped_release unlocked;
                 result = crosscheck(sources, engines, choice, steps, leave);
               }
               return dict_of(result);
             });
  module.def("explore", [](const std::string& study, const std::string& out, int jobs, bool speed) {
    Table table;
    {
      py::gil_scoped_release unlocked;
      table = explore({study, out, jobs, speed});
    }
    return tuple_of(table);
  });
  module.def("check", check);
  add_measures(module);
  module.def("read_text", [](const std::string& path) {
    std::string text = read_config_text(path);
    check_utf8(text, path);
    return text;
  });
  module.def("check_toml",
             [](const std::string& text, const std::string& path) { parse_config(text, path); });
  module.def("template_text", &template_text);
  module.def("set_program_directory", &set_program_directory);
  module.def("look_for_parts_in", &look_for_parts_in);
}

}  // namespace cuboct::python
