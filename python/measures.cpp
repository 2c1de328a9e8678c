// SPDX-License-Identifier: MIT
#include "python/measures.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/run/measure_run.h"
#include "cli/run/outputs.h"
#include "model/base/error.h"
#include "python/catch_interrupt.h"

namespace py = pybind11;

namespace cuboct::python {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// What was asked for, as Python gives it: read without the scene.
struct Given {
  MeasureAsked asked;
  std::optional<std::string> cutoff_text, volume_text;
  bool particles = false;

  // With the scene's units.
  MeasureAsked of(const Scene& scene) const {
    MeasureAsked with = asked;
    const bool reduced = scene.boltzmann == 1;
    if (cutoff_text) with.choice.cutoff = size_of("cutoff", *cutoff_text, false, reduced);
    if (volume_text) with.choice.volume = size_of("volume", *volume_text, true, reduced);
    return with;
  }
};

// A length or volume: in SI, or a text with a unit.
void take_size(const py::dict& options, const char* name, std::optional<double>& value,
               std::optional<std::string>& text) {
  if (!options.contains(name)) return;
  if (py::isinstance<py::str>(options[name])) {
    text = options[name].cast<std::string>();
    return;
  }
  value = options[name].cast<double>();
  if (!(*value > 0 && *value < 1e300)) throw InputError(fmt::format("{} = {}: it is above 0", name, *value));
}

Given given_of(const std::string& name, const std::string& frames, const py::dict& options) {
  Given given;
  MeasureChoice& choice = given.asked.choice;
  given.asked.name = name, given.asked.frames = frames;
  choice.option = "";
  take_size(options, "cutoff", choice.cutoff, given.cutoff_text);
  take_size(options, "volume", choice.volume, given.volume_text);
  if (options.contains("bins")) {
    choice.bins = options["bins"].cast<uint64_t>();
    if (*choice.bins < 1 || *choice.bins > kMostBins)
      throw InputError(fmt::format("bins = {}: 1 to {}", *choice.bins, kMostBins));
  }
  if (options.contains("types")) choice.types = options["types"].cast<std::vector<std::string>>();
  if (options.contains("threads")) {
    choice.threads = options["threads"].cast<int>();
    if (choice.threads < 1) throw InputError(fmt::format("threads = {}: at least 1", choice.threads));
  }
  choice.com = options.contains("com"), choice.virial = options.contains("virial");
  given.particles = options.contains("particles");
  return given;
}

// Of all frames, [frame][particle x its numbers].
struct OfParticles {
  std::string name, unit;
  size_t numbers = 1, frames = 0, count = 0;
  std::vector<double> values;

  void add(const MeasuredParticles& of) {
    name = of.name, unit = of.unit;
    numbers = std::max<size_t>(1, of.components.size());
    count = of.values.size() / numbers;
    values.insert(values.end(), of.values.begin(), of.values.end());
    ++frames;
  }
};

py::array array_of(const std::vector<double>& values, bool whole) {
  if (!whole) return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
  py::array_t<uint64_t> array(static_cast<py::ssize_t>(values.size()));
  std::transform(values.begin(), values.end(), array.mutable_data(),
                 [](double one) { return static_cast<uint64_t>(one); });
  return array;
}

// (columns, units, notes, particles)
py::tuple tuple_of(const Measured& measured, const OfParticles& particles) {
  py::dict columns, units, notes;
  for (const MeasuredColumn& column : measured.columns) {
    columns[column.name.c_str()] = array_of(column.values, column.whole);
    units[column.name.c_str()] = column.unit;
  }
  for (const auto& [name, text] : measured.notes) notes[name.c_str()] = text;
  py::object all = py::none();
  if (particles.frames > 0) {
    py::array flat = array_of(particles.values, particles.unit == "1");
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(particles.frames),
                                   static_cast<py::ssize_t>(particles.count)};
    if (particles.numbers > 1) shape.push_back(static_cast<py::ssize_t>(particles.numbers));
    all = flat.reshape(shape);
    units["particles"] = particles.unit;
  }
  return py::make_tuple(columns, units, notes, all);
}

std::vector<Vec3> vectors_of(const Array& array, size_t count) {
  if (array.ndim() != 2 || array.shape(0) != static_cast<py::ssize_t>(count) || array.shape(1) != 3)
    throw InputError(fmt::format("positions and velocities are arrays of {} x 3 numbers", count));
  std::vector<Vec3> out(count);
  const double* from = array.data();
  for (Vec3& one : out) one = Vec3(from[0], from[1], from[2]), from += 3;
  return out;
}

py::tuple measure_matter(const Matter& matter, const std::string& name, const std::string& frames,
                         const py::dict& options, const std::vector<uint64_t>& steps,
                         const std::vector<Array>& x, const std::vector<Array>& v) {
  const Scene& scene = *matter.scene;
  const Given given = given_of(name, frames, options);
  const MeasureAsked asked = given.of(scene);
  OfParticles particles;
  const auto snapshot = [&](size_t k) {
    py::gil_scoped_acquire locked;
    Snapshot now{steps[k], {}, matter.wrapped, matter.late};
    now.body.x = vectors_of(x.at(k), scene.body.size()), now.body.v = vectors_of(v.at(k), scene.body.size());
    now.body.type = scene.body.type;
    return now;
  };
  Measured measured;
  {
    py::gil_scoped_release unlocked;
    std::function<void(size_t, const Snapshot&, const MeasuredParticles&)> see;
    if (given.particles)
      see = [&](size_t, const Snapshot&, const MeasuredParticles& of) { particles.add(of); };
    measured = measure_snapshots(scene, steps, snapshot, asked, see);
  }
  return tuple_of(measured, particles);
}

py::tuple measure_directory(const std::string& directory, const std::string& name, const std::string& frames,
                            const py::dict& options) {
  const Given given = given_of(name, frames, options);
  OfParticles particles;
  Measured measured;
  {
    py::gil_scoped_release unlocked;
    const RunRecord record = read_record(directory);
    const Trace trace = read_run(directory, record);
    const Loaded loaded = scene_of_run(directory, record, trace);
    SeeParticles see;
    if (given.particles)
      see = [&](const KeptFrame&, const Snapshot&, const MeasuredParticles& of) { particles.add(of); };
    measured = measure_trace(loaded, trace, given.of(loaded.scene), see);
  }
  return tuple_of(measured, particles);
}

}  // namespace

void add_measures(py::module_& module) {
  py::class_<Matter>(module, "Matter").def("measure", &measure_matter);
  module.def("measure", &measure_directory);
}

}  // namespace cuboct::python
