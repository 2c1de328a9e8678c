// SPDX-License-Identifier: MIT
#include "emu/gpu/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "emu/gpu/particle.h"
#include "model/atoms/multiscale/element_body.h"
#include "model/base/error.h"

namespace cuboct::gpu {

const char* to_string(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::fixed ? "fixed" : arithmetic == Arithmetic::float32 ? "float" : "double";
}

void throw_too_many(uint64_t particles, uint64_t most) {
  throw InputError(
      fmt::format("{} particles on one device, copies of its neighbours' included: a pair list's entry "
                  "tells {} apart",
                  particles, most),
      "use more devices");
}

void throw_too_dense(uint64_t others) {
  throw std::runtime_error(
      fmt::format("a particle has {} others inside the cutoff and the skin: matter has collapsed", others));
}

void throw_few_planes(int slabs, int planes) {
  throw InputError(
      fmt::format("{} slabs of a plane of cells or more: the scene has {} along its longest axis", slabs,
                  planes),
      "use fewer devices");
}

void throw_far_particle(size_t particle) {
  throw InputError(fmt::format("particle {} is more than 1e9 cells away from the first", particle))
      .about({"particle", "particles.file", "packing"});
}

void throw_not_finite(uint64_t step, uint32_t fastest, double speed) {
  throw LostPosition(
      fmt::format(
          "step {}: a position leaves all bounds; before it particle {} was the fastest, at {:.4g} m/s",
          step + 1, fastest, speed),
      step, fastest);
}

void throw_not_compiled(const char* numbers, const std::string& why) {
  throw InputError(fmt::format("a rule of text in {}s is compiled for the device: {}", numbers, why),
                   "the package nvidia-cuda-nvrtc has CUDA's compiler; --precision fixed needs none");
}

std::string table_ends_text(uint64_t step) {
  return fmt::format("step {}: a table is asked for more than it has; is dt too long?", step);
}

void require_devices(const Options& options) {
  if (options.block < 32 || options.block > 256 || options.block % 32 != 0)
    throw InputError(fmt::format("a block of {} threads", options.block), "a multiple of 32 from 32 to 256");
  if (options.devices.empty() || options.devices.size() > size_t{kMostSlabs})
    throw InputError(fmt::format("{} slabs", options.devices.size()),
                     fmt::format("from 1 to {}", kMostSlabs));
  std::string why;
  const std::vector<Device> devices = find_devices(&why);
  if (devices.empty()) throw InputError(fmt::format("the gpu engine needs a CUDA device: {}", why));
  for (const int ordinal : options.devices)
    if (std::none_of(devices.begin(), devices.end(), [&](const Device& d) { return d.ordinal == ordinal; }))
      throw InputError(fmt::format("there is no CUDA device {}", ordinal),
                       devices.size() == 1
                           ? "this machine has one: 0"
                           : fmt::format("this machine has {}: 0 to {}", devices.size(), devices.size() - 1));
}

void require_widths(const Widths& widths) {
  if (widths.position_frac > kMostVisibleBits)
    throw InputError(
        fmt::format("position_frac = {}: the gpu engine's positions hold {} bits of a cell at most",
                    widths.position_frac, kMostVisibleBits))
        .about({"widths.position_frac"});
  if (widths.guard > kMostResidueBits)
    throw InputError(
        fmt::format("guard = {}: the gpu engine keeps {} bits of a position beside those at most",
                    widths.guard, kMostResidueBits))
        .about({"widths.guard"});
}

void require_memory(const Options& options, uint64_t particles, uint64_t cells, double bytes_per_particle) {
  const size_t slabs = options.devices.size();
  // Slabs have about equal shares; their copies of neighbours' particles and what grows take a tenth.
  const double slab = 1.1 * static_cast<double>(particles) / static_cast<double>(slabs) * bytes_per_particle +
                      4.0 * static_cast<double>(cells);
  std::map<int, int> slabs_on;
  for (const int ordinal : options.devices) ++slabs_on[ordinal];
  for (const Device& device : find_devices()) {
    const auto it = slabs_on.find(device.ordinal);
    if (it == slabs_on.end()) continue;
    const double needed = slab * it->second;
    if (needed <= static_cast<double>(device.free)) continue;
    throw InputError(
        fmt::format("{} particles need {:.1f} GiB on device {} ({}), which has {:.1f} GiB free", particles,
                    needed / 0x1p30, device.ordinal, device.name, static_cast<double>(device.free) / 0x1p30),
        fmt::format("about {} particles fit, or use more devices",
                    static_cast<uint64_t>(static_cast<double>(device.free) / needed *
                                          static_cast<double>(particles))));
  }
}

void require_tables(const Options& options, uint64_t bytes) {
  for (const Device& device : find_devices())
    if (std::count(options.devices.begin(), options.devices.end(), device.ordinal) > 0 &&
        bytes > device.block_memory)
      throw InputError(fmt::format("the rule's tables take {} bytes, and a block of device {} ({}) holds {}",
                                   bytes, device.ordinal, device.name, device.block_memory),
                       "fewer of the arch's table.index_bits")
          .about({"table.index_bits"});
}

Device device_at(int ordinal) {
  std::string why;
  const std::vector<Device> devices = find_devices(&why);
  if (devices.empty()) throw InputError("no GPU: " + why);
  for (const Device& device : devices)
    if (device.ordinal == ordinal) return device;
  throw InputError(fmt::format("--device: there is no CUDA device {}", ordinal));
}

void throw_thin_cell(size_t sample, double thickness, double reach) {
  throw InputError(
      fmt::format("sample {}: its cell is {:.4g} angstrom thick, less than the reach of the forces, {:.4g}",
                  sample, thickness, reach),
      "cutoff and skin of the bonds make the reach");
}

void throw_crushed_element(size_t element, double thickness, double reach) {
  throw ElementError(element,
                     fmt::format("its sample is {:.4g} angstrom thick, less than the reach of the forces, "
                                 "{:.4g}, which a GPU needs",
                                 thickness, reach));
}

void require_sample(int device, uint64_t atoms, uint64_t bonds, uint64_t bytes) {
  uint64_t has = 0;
  for (const Device& found : find_devices(nullptr))
    if (found.ordinal == device) has = found.block_memory;
  if (bonds <= 0xffff && bytes <= has) return;
  throw InputError(
      fmt::format("a sample of {} atoms with {} bonds takes {} bytes; a block of device {} has {}", atoms,
                  bonds, bytes, device, has));
}

void throw_lost_sample(size_t sample) {
  throw std::runtime_error(fmt::format("sample {}: a force is not finite", sample));
}

void require_lps(const Rule& rule, const LpsMaterial& material) {
  if (material.corrected)
    throw InputError("the GPU's peridynamic solid has no free-surface correction",
                     "leave surface_correction out, or use the reference engine");
  for (const ParticleType& type : rule.types)
    if (type.pd)
      throw InputError(
          fmt::format("the GPU's peridynamic solid has no '{}', held or moved by force", type.name),
          "kind = \"held\", \"moved\" or \"pulled\", or the reference engine");
}

void require_lps_memory(int device, uint64_t particles, uint64_t bytes) {
  for (const Device& found : find_devices(nullptr))
    if (found.ordinal == device && bytes > found.free)
      throw InputError(
          fmt::format("{} points and their bonds need {:.1f} GiB on device {} ({}), which has "
                      "{:.1f} GiB free",
                      particles, static_cast<double>(bytes) / 0x1p30, device, found.name,
                      static_cast<double>(found.free) / 0x1p30));
}

void throw_lost_point(uint64_t step, uint32_t particle) {
  throw std::runtime_error(fmt::format(
      "up to step {}: particle {} has a position that is not finite; is dt too long?", step, particle));
}

}  // namespace cuboct::gpu
