// SPDX-License-Identifier: MIT
#include "hw/plan/setup.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "hw/arch/cell_box.h"
#include "hw/plan/probe_accuracy.h"
#include "hw/plan/reach.h"
#include "model/base/hash.h"
#include "model/contract/quantise.h"
#include "model/graph/certificate.h"
#include "model/program/bond_graph.h"
#include "model/program/integer_program.h"
#include "model/program/program_rule.h"

namespace cuboct {
namespace {

std::optional<CellEdges> edges_by_axis(const Vec3& extent, double least) {
  Vec3 edge = Vec3::Zero();
  for (int a = 0; a < 3; ++a) {
    if (extent[a] == 0) continue;
    const double count = std::floor(extent[a] / least * (1 + 1e-12));
    if (count < 3) return std::nullopt;
    edge[a] = extent[a] / count;
  }
  CellEdges edges(edge.maxCoeff());
  for (int a = 0; a < 3; ++a)
    if (edge[a] > 0) edges.shape[static_cast<size_t>(a)] = edge[a] / edges.longest;
  return edges;
}

// A periodic axis must be a ring of whole cells. Cubes: of the shortest edge, not below `least`, that divides
// every periodic extent; without periodic axes it is `least`. Where there is none, and any cells will do,
// each periodic axis has an edge of its own, and others have the longest of these.
CellEdges periodic_edges(const Scene& scene, double least, CellForm form) {
  constexpr double kMostInRow = 1e7;
  const Vec3& extent = scene.periodic.extent;
  const double longest = extent.maxCoeff();
  if (longest <= 0) return least;
  const std::vector<std::string> causes{"box.size", "box.cells", "box", "particles.file"};
  if (longest / least > kMostInRow)
    scene.places.fail(
        causes, fmt::format("the periodic box is {:.3g} cells of {:.4g} m long: at most {:.3g} can be built",
                            longest / least, least, kMostInRow));
  for (int n = static_cast<int>(std::floor(longest / least * (1 + 1e-12))); n >= 3; --n) {
    const double edge = longest / n;
    bool fits = true;
    for (int a = 0; a < 3; ++a) {
      const double count = extent[a] / edge;
      if (extent[a] > 0 && (std::abs(count - std::round(count)) > 1e-9 * count || std::round(count) < 3))
        fits = false;
    }
    if (fits) return edge;
  }
  if (form == CellForm::any)
    if (const std::optional<CellEdges> edges = edges_by_axis(extent, least)) return *edges;
  scene.places.fail(
      causes,
      fmt::format(
          "no cell edge of at least {:.6g} m divides the periodic box {:.6g} x {:.6g} x {:.6g} m into 3 "
          "or more cells per axis",
          least, extent[0], extent[1], extent[2]),
      form == CellForm::any
          ? fmt::format("use a larger box: {:.6g} m or more along each periodic axis", 3 * least)
          : "use a larger box, or one whose sides have a common part; engines golden, lattice and "
            "gpu need no such part");
}

// Whether nothing happens along z: all particles share one height, none moves, is pulled or driven off it,
// to the last bit of the fixed rule. Then the heights can be the lower faces of one layer of cells, and every
// d_z, and with it every kick along z, is 0 (docs/reference/plan.md).
bool is_flat(const Scene& scene, const FixedRule& rule, double lowest) {
  if (scene.periodic.extent[2] > 0 || scene.body.size() == 0) return false;
  for (const FixedType& type : rule.types)
    if (type.velocity[2] != 0 || type.gravity[2] != 0) return false;
  const double unit = position_units(rule)[2];
  const Body& body = scene.body;
  for (size_t id = 0; id < body.size(); ++id) {
    if (std::llround((body.x[id][2] - lowest) / unit) != 0) return false;
    if (!rule.types[body.type[id]].imposed[2] && std::llround(body.v[id][2] * rule.dt / unit) != 0)
      return false;
    if (!body.u.empty() && std::llround(body.u[id][2] / unit) != 0) return false;
  }
  return true;
}

// What cells may come to hold, at the least: 4 of an FCC packing's cubic cell, four times over.
constexpr int kLeastCapacity = 16;
constexpr int kMostCapacity = 256;  // of an arch
// Particles that stand closer to a face than this share of the distance at rest may come in.
constexpr double kMayComeIn = 0.2;

// Particles that the fullest cell may hold with those that may come in through its faces, and a quarter more:
// a multiple of four. A power of two that holds the former is enough: with one particle more, each memory
// doubles.
int capacity_for(const Scene& scene, const Lattice& lattice, const CellEdges& edges, const Vec3& origin) {
  const double pitch = scene.pitch > 0 ? scene.pitch : scene.rule.cutoff();
  std::vector<uint32_t> count(lattice.size(), 0);
  for (const Vec3& x : scene.body.x) {
    std::array<std::array<int32_t, 2>, 3> near;
    for (int a = 0; a < 3; ++a) {
      const double at = (x[a] - origin[a]) / edges[a], reach = kMayComeIn * pitch / edges[a];
      near[a] = {static_cast<int32_t>(std::floor(at - reach)), static_cast<int32_t>(std::floor(at + reach))};
    }
    for (int32_t cz = near[2][0]; cz <= near[2][1]; ++cz)
      for (int32_t cy = near[1][0]; cy <= near[1][1]; ++cy)
        for (int32_t cx = near[0][0]; cx <= near[0][1]; ++cx)
          if (const uint32_t cell = lattice.find({cx, cy, cz}); cell != kNoCell) ++count[cell];
  }
  const uint32_t fullest = count.empty() ? 0 : *std::max_element(count.begin(), count.end());
  const uint32_t roomy = 4 * ((5 * fullest + 15) / 16), power = std::bit_floor(roomy);
  return std::clamp(static_cast<int>(power >= fullest ? power : roomy), kLeastCapacity, kMostCapacity);
}

// The rule in integers. Where formats that the arch file sets cannot hold it, the hint names those that can.
FixedRule fixed_rule(const Scene& scene, const Arch& arch, const CellEdges& edges, const AutoWidths& chosen) {
  try {
    return quantise(scene.rule, edges, chosen.widths, arch.table, chosen.half_unit);
  } catch (const InputError& error) {
    const AutoWidths free = auto_widths(scene, edges.longest, automatic_widths());
    std::string changes;
    for (const WidthReason& reason : chosen.reasons)
      for (const WidthReason& other : free.reasons)
        if (reason.key == other.key && reason.asked && other.bits != reason.bits)
          changes += fmt::format("{}{} = {}", changes.empty() ? "" : ", ", other.key, other.bits);
    if (changes.empty()) throw;
    try {
      quantise(scene.rule, edges, free.widths, arch.table, free.half_unit);
    } catch (const InputError&) {
      throw error;
    }
    throw error.with(fmt::format("widths that hold it: {}; or leave them to \"auto\"", changes));
  }
}

// Every cell of the box around `cells`.
std::vector<Cell> filled_box(const std::vector<Cell>& cells, const Arch& arch) {
  CellBox around;
  for (const Cell& cell : cells) around.add(cell);
  const auto& [low, high] = around;
  double count = 1;
  for (size_t a = 0; a < 3; ++a) count *= static_cast<double>(around.extent(a));
  if (count > kMostCells)
    arch.places.fail(
        {"plan.carry"},
        fmt::format(
            "plan.carry = [\"empty_nodes\"]: the bounding box has {:.4g} cells, at most {:.3g} can be built",
            count, kMostCells));
  std::vector<Cell> box;
  box.reserve(static_cast<size_t>(count));
  for (int32_t z = low[2]; z <= high[2]; ++z)
    for (int32_t y = low[1]; y <= high[1]; ++y)
      for (int32_t x = low[0]; x <= high[0]; ++x) box.push_back({x, y, z});
  return box;
}

const RuleProgram* text_of(const Rule& rule) {
  const RoundsRule* rounds = rule.rounds.get();
  return rounds == nullptr ? nullptr : rounds->text();
}

void add_program(const RuleProgram& text, const Scene& scene, const Body& begin, Plan& plan) {
  set_program(plan,
              std::make_shared<IntegerProgram>(integer_program(
                  text, plan.rule, plan.arch.capacity, starts_of(text, scene.rule, begin, scene.periodic))));
  const std::string certificate = graph::certificate_of(plan.program->program);
  if (const graph::Refusal refusal = graph::refusal_of(certificate); refusal.line != 0)
    throw std::logic_error(
        fmt::format("line {} of the program's certificate: {}", refusal.line, refusal.what));
}

// `see` is given each particle of the initial state once, in the order of ids.
template <typename See>
Plan plan_with(const Scene& scene, Arch arch, CellForm form, See see, bool programs = false) {
  const RuleProgram* text = programs ? text_of(scene.rule) : nullptr;
  if (text == nullptr) refuse_rounds(scene.rule, "a machine");
  const CellEdges edges = cell_edges_of(scene, arch, form);
  const double edge = edges.longest;
  // Cells start a quarter of an edge below the packing, so that the planes of an aligned crystal do not lie
  // on faces; along z a flat body's only plane does.
  Vec3 origin = Vec3::Constant(INFINITY);
  for (const Vec3& x : scene.packing().x) origin = origin.cwiseMin(x);
  AutoWidths chosen = auto_widths(scene, edge, arch.widths);
  FixedRule rule = text != nullptr ? quantise_without_law(scene.rule, edges, chosen.widths)
                                   : fixed_rule(scene, arch, edges, chosen);
  if (asks_accuracy(scene)) refine_for_probes(scene, arch, edges, chosen, rule);
  arch.widths = rule.widths;
  arch.table.index_bits = rule.force.index_bits;
  const double lowest = origin[2];
  const bool flat = is_flat(scene, rule, lowest);
  Cell period{};
  for (int a = 0; a < 3; ++a) {
    origin[a] -= 0.25 * edges[a];
    if (scene.periodic.extent[a] > 0) {
      period[a] = static_cast<int32_t>(std::lround(scene.periodic.extent[a] / edges[a]));
      origin[a] = scene.periodic.origin[a];
    }
  }

  // And half a unit of a visible position lower: a particle on a multiple of the unit stands in the middle of
  // the range that looks the same.
  for (int a = 0; a < 3; ++a) origin[a] -= std::ldexp(0.5 * edges[a], -rule.widths.position_frac);
  if (flat) origin[2] = lowest;
  rule.axes = flat ? 2 : 3;
  std::vector<Cell> cells = reachable_cells(scene, edges, origin, period, rule.axes);
  if (arch.carry.empty_nodes) cells = filled_box(cells, arch);
  Lattice lattice(std::move(cells), period);
  rule = carrying(std::move(rule), arch.carry);
  if (arch.capacity == kAutomatic) arch.capacity = capacity_for(scene, lattice, edges, origin);
  std::vector<uint32_t> count(lattice.size(), 0);
  uint32_t fullest = 0;
  for (uint32_t id = 0; id < scene.body.size(); ++id) {
    const Particle particle = fixed_particle(scene.body, id, rule, lattice, origin);
    fullest = std::max(fullest, ++count[particle.cell]);
    see(particle);
  }
  if (static_cast<int64_t>(fullest) > arch.capacity)
    arch.places.fail(
        {"node.capacity"},
        fmt::format("a cell would hold {} particles: its capacity is {}", fullest, arch.capacity),
        fullest <= kMostCapacity ? fmt::format("set node.capacity to at least {} in the arch file", fullest)
        : edges.shortest() > scene.rule.cutoff() * (1 + 1e-9)
            ? fmt::format("a cell holds at most {}: a shorter node.cell_edge", kMostCapacity)
            : fmt::format(
                  "a cell, as long as the pair law's cutoff, holds at most {}: a shorter cutoff, or doubles "
                  "(--engine reference)",
                  kMostCapacity));
  std::vector<std::string> warnings;
  if (text == nullptr) warnings = width_warnings(scene, edge, chosen, rule);
  for (const MeshFacts& mesh : scene.meshes)
    if (std::string warning = mesh_warning(mesh); !warning.empty()) warnings.push_back(std::move(warning));
  Plan plan = make_plan(std::move(rule), std::move(arch), std::move(lattice), origin,
                        static_cast<uint32_t>(scene.body.size()));
  if (text != nullptr) add_program(*text, scene, scene.body, plan);
  plan.reasons = chosen.reasons;
  plan.warnings = std::move(warnings);
  return plan;
}

// Gives the whole pages among a vector's elements [first, last) back to the system; those elements become
// zeros. (A vector cannot shrink at its front.)
template <typename T>
void give_back(std::vector<T>& values, size_t first, size_t last) {
  static const auto page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
  char* const bytes = reinterpret_cast<char*>(values.data());
  const auto before = reinterpret_cast<uintptr_t>(bytes);
  const auto begin = (before + first * sizeof(T) + page - 1) / page * page;
  const auto end = (before + last * sizeof(T)) / page * page;
  if (begin < end) madvise(bytes + (begin - before), end - begin, MADV_DONTNEED);
}

}  // namespace

Particle InitialParticles::operator()(uint32_t id) {
  constexpr uint32_t kBlock = 1 << 16;
  if (id > 0 && id % kBlock == 0) {
    // A page that reaches into the block before went with neither block: a few remain.
    give_back(body_.x, id - kBlock, id);
    give_back(body_.v, id - kBlock, id);
    give_back(body_.type, id - kBlock, id);
    if (!body_.u.empty()) give_back(body_.u, id - kBlock, id);
  }
  return fixed_particle(body_, id, plan_.rule, plan_.lattice, plan_.origin);
}

CellEdges cell_edges_of(const Scene& scene, const Arch& arch, CellForm form) {
  // A bond that counts is met among the 27 cells, however it is stretched within its tables.
  const RuleProgram* text = text_of(scene.rule);
  const bool lasting = text != nullptr && text->declaration.bonds == BondRange::reference;
  const double cutoff = scene.rule.cutoff() * (lasting ? 1 + kBondStretch : 1);
  if (arch.cell_edge > 0 && arch.cell_edge < cutoff)
    arch.places.fail(
        {"node.cell_edge"},
        fmt::format("cell_edge = {:.6g} m is shorter than {}, {:.6g} m", arch.cell_edge,
                    lasting ? "the reach of bonds that stretch by 1/8" : "the pair law's cutoff", cutoff));
  return periodic_edges(scene, std::max(cutoff, arch.cell_edge), form);
}

Arch settled(const Scene& scene, Arch arch) {
  const CellEdges edges = cell_edges_of(scene, arch, CellForm::any);
  AutoWidths chosen = auto_widths(scene, edges.longest, arch.widths);
  if (asks_accuracy(scene)) {
    FixedRule rule = fixed_rule(scene, arch, edges, chosen);
    refine_for_probes(scene, arch, edges, chosen, rule);
  }
  arch.widths = chosen.widths;
  return arch;
}

Plan plan_of(const Scene& scene, const Arch& arch, CellForm form) {
  return with_places(scene, arch, [&] { return plan_with(scene, arch, form, [](const Particle&) {}); });
}

Plan program_plan_of(const Scene& scene, const Arch& arch, CellForm form) {
  return with_places(scene, arch, [&] {
    return plan_with(
        scene, arch, form, [](const Particle&) {}, true);
  });
}

Setup make_setup(const Scene& scene, const Arch& arch) {
  State initial;
  initial.particles.reserve(scene.body.size());
  const auto keep = [&](const Particle& particle) { initial.particles.push_back(particle); };
  Plan plan = with_places(scene, arch, [&] { return plan_with(scene, arch, CellForm::cubes, keep); });
  return {std::move(plan), std::move(initial)};
}

Setup going_on(const Scene& scene, const Plan& before, const State& now, const Body& begin) {
  const FixedRule& old = before.rule;
  const Arch& arch = before.arch;
  FixedRule rule = with_places(scene, arch, [&] {
    return before.program ? quantise_without_law(scene.rule, old.edges(), old.widths)
                          : quantise(scene.rule, old.edges(), old.widths, arch.table);
  });
  rule.axes = old.axes;
  for (const FixedType& type : rule.types)
    if (rule.axes == 2 && (type.velocity[2] != 0 || type.gravity[2] != 0))
      throw InputError("the scene began flat, and its machine has no third axis: nothing can move along z",
                       "a scene whose own constraints or gravity act along z is built with three axes");
  std::vector<Cell> cells =
      reachable_cells(scene, old.edges(), before.origin, before.lattice.period(), rule.axes);
  if (arch.carry.empty_nodes) cells = filled_box(cells, arch);
  Lattice lattice(std::move(cells), before.lattice.period());
  State state = now;
  for (Particle& particle : state.particles) particle.cell = lattice.find(before.lattice.cell(particle.cell));
  Plan plan = make_plan(carrying(std::move(rule), arch.carry), arch, std::move(lattice), before.origin,
                        before.particles);
  if (before.program)
    with_places(scene, arch, [&] { add_program(*text_of(scene.rule), scene, begin, plan); });
  plan.reasons = before.reasons;
  plan.warnings = before.warnings;
  return {std::move(plan), std::move(state)};
}

}  // namespace cuboct
