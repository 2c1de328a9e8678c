// SPDX-License-Identifier: MIT
#include "model/trace/trace_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/base/hash.h"
#include "model/scene/first_step.h"
#include "model/trace/hdf5_file.h"

namespace cuboct {
namespace {

using hdf5::Handle;
using hdf5::Writer;

std::vector<double> triple(const Vec3& v) { return {v[0], v[1], v[2]}; }

void write_widths(const Writer& out, const Widths& w) {
  const auto number = [&](const char* name, int value) { out.number<int32_t>(out.root(), name, value); };
  number("position_frac", w.position_frac);
  number("guard", w.guard);
  number("difference_frac", w.difference_frac);
  number("velocity_bits", w.velocity_bits);
  number("relative_velocity_frac", w.relative_velocity_frac);
  number("relative_velocity_bits", w.relative_velocity_bits);
  number("filter_frac", w.filter_frac);
  number("strength_bits", w.strength_bits);
  number("sum_bits", w.sum_bits);
  number("displacement_bits", w.displacement_bits);
  number("scale_frac", w.scale_frac);
  number("gain_frac", w.gain_frac);
}

void write_lattice(const Writer& out, const Lattice& lattice) {
  const Handle group = out.group(out.root(), "lattice");
  out.numbers<int32_t>(group, "period", {lattice.period().begin(), lattice.period().end()});
  const hsize_t chunk = std::clamp<hsize_t>(lattice.size(), 1 << 10, (1 << 15) / 3);
  hdf5::Growing<int32_t> cells(out, group, "cell", chunk, 3, "cell edge",
                               "[node][axis] coordinates of the node's cell");
  for (uint32_t cell = 0; cell < lattice.size(); ++cell) cells.add(lattice.cell(cell).data());
  cells.finish();
}

// At most what the head takes of the disk.
uint64_t bytes_of(const TraceHead& head) {
  uint64_t bytes = (uint64_t{1} << 18) + 2 * (head.scene.text.size() + head.arch.size());
  for (const ParticleType& type : head.scene.rule.types) bytes += 2 * type.name.size();
  if (head.rule && head.cells) bytes += 13 * uint64_t{head.lattice->size()};
  return bytes;
}

}  // namespace

const char* program_version() { return CUBOCT_VERSION; }

uint64_t packing_hash(const Scene& scene) {
  const Body& body = scene.packing();
  double farthest = scene.packing_box().extent.maxCoeff();
  for (const Vec3& x : body.x) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  // A last bit that came out otherwise is no other packing: 30 bits count, and round numbers, which are
  // frequent, do not stand where rounding turns.
  const double unit = farthest > 0 ? std::ldexp(1.0, std::ilogb(farthest) - 30) : 1;
  Hash hash;
  const auto add = [&](const Vec3& v) {
    for (const double c : v) hash.add(std::llround(c / unit + 0.137));
  };
  add(scene.packing_box().extent);
  for (const Vec3& x : body.x) add(x);
  return hash.value();
}

void write_head(const Writer& out, const TraceHead& head) {
  out.reserve(bytes_of(head));
  const Scene& scene = head.scene;
  const hid_t root = out.root();
  out.text(root, "program_version", program_version());
  out.text(root, "units", "SI (m, kg, s, N, J, Pa, K), but for integers, whose datasets say their unit");
  out.text(root, "title", scene.title);
  out.number<double>(root, "dt", scene.rule.dt);
  out.number<double>(root, "mass", scene.rule.mass);
  out.numbers<double>(root, "periodic_origin", triple(scene.periodic.origin));
  out.numbers<double>(root, "periodic_extent", triple(scene.periodic.extent));
  if (scene.deform) {
    out.numbers<double>(root, "box_strain", triple(scene.deform->strain));
    out.numbers<double>(root, "box_strain_per_step", triple(scene.deform->per_step));
  }
  std::vector<std::string> types;
  for (const ParticleType& type : scene.rule.types) types.push_back(type.name);
  out.names(root, "types", types);
  if (!scene.rule.masses.empty()) {
    std::vector<double> masses;
    for (size_t k = 0; k < types.size(); ++k) masses.push_back(scene.rule.mass_of(static_cast<int>(k)));
    out.numbers<double>(root, "masses", masses);
  }
  out.number<uint64_t>(root, "packing", packing_hash(scene));
  if (const uint64_t first = first_step_of(scene.rule)) out.number<uint64_t>(root, "first_step", first);
  {
    // Datasets: HDF5 holds no attribute above 64 KiB.
    const Handle source = out.group(root, "source");
    out.text(source, "scene_path", scene.path);
    out.names(source, "scene", {scene.text});
    out.names(source, "arch", {head.arch});
    if (!scene.stage.empty()) out.text(source, "stage", scene.stage);
    if (scene.began)
      out.text(source, "began", fmt::format("step {} of {}", scene.began->step, scene.began->from));
  }
  if (!head.rule) return out.flush();
  out.number<double>(root, "cell_edge", head.rule->cell_edge);
  if (const CellShape& shape = head.rule->shape; !head.rule->cubic())
    out.numbers<double>(root, "cell_shape", {shape[0], shape[1], shape[2]});
  out.numbers<double>(root, "origin", triple(head.origin));
  write_widths(out, head.rule->widths);
  if (head.cells) write_lattice(out, *head.lattice);
  out.flush();
}

}  // namespace cuboct
