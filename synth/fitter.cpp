// SPDX-License-Identifier: MIT
#include "synth/fitter.h"

#include <fmt/format.h>

#include <algorithm>

#include "hw/engine/scene_engine.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/clock.h"
#include "model/base/interrupt.h"
#include "model/config/changes.h"
#include "model/config/config.h"
#include "synth/tool.h"

namespace cuboct::synth {
namespace {

// Of lanes, between which the lines of the model are drawn.
constexpr int kManyLanes = 8;
// Bricks that cannot be emitted, after which no other is tried.
constexpr size_t kMostRefused = 4;

constexpr const char* kHeading = "# Brick, lanes and pipes as cuboct emit --fit ";

// A plan that has no RTL; another brick may have. What else goes wrong in a synthesis goes wrong for all.
struct NotEmitted : InputError {
  explicit NotEmitted(const InputError& error) : InputError(error) {}
};

std::string text_of(const std::string& arch) {
  return arch.empty() ? "name = \"default\"\n" : read_config_text(arch);
}

std::string with_choice(const std::string& text, const std::string& path, const FitPoint& p) {
  return with_changes(text, path,
                      {{"node.brick", fmt::format("[{}, {}, {}]", p.brick[0], p.brick[1], p.brick[2])},
                       {"node.filter_lanes", std::to_string(p.lanes)},
                       {"node.force_pipes", std::to_string(p.pipes)}});
}

// With the least brick, lanes and pipes: those of the file are not what is asked for.
Arch least(Arch arch) {
  if (arch.halos == Halos::arrival)
    arch.places.fail({"node.halos"}, "--fit chooses among bricks, whose halos are used by phases",
                     "set halos = \"phases\" and streamers = 1, or emit without --fit");
  arch.brick = {1, 1, 1};
  arch.filter_lanes = arch.force_pipes = 1;
  return arch;
}

}  // namespace

int fullest(const PairCensus& census, uint32_t cells) {
  uint64_t most = 1;
  for (uint32_t n = 0; n < cells; ++n) most = std::max(most, census.particles(n));
  return static_cast<int>(most);
}

const Target& fit_target(const std::string& name, const BoardChoice& board) {
  const Target& target = target_of(name);
  if (target.family == Family::asic)
    throw InputError("--fit asic: standard cells have no limit to fit", "--fit is for FPGAs");
  if (!board.name.empty() && board_of(board.name).target != name)
    throw InputError(fmt::format("--fit {}: the board {} has another device", name, board.name),
                     "--fit " + board_of(board.name).target);
  return target;
}

Fitter::Fitter(const std::string& scene, const std::string& arch, const Target& target,
               const BoardChoice& board, std::function<void(const std::string&)> says,
               std::function<void(const std::string&)> tells)
    : scene_path_(scene),
      arch_path_(arch),
      target_(target),
      board_(board),
      says_(std::move(says)),
      tells_(std::move(tells)),
      meter_(target,
             [this](const std::string& what, int seconds) {
               announce();
               if (seconds > 0) says_(fmt::format("{}: {}, {} s", at_work_, what, seconds));
             }),
      scene_(read_scene(scene)),
      arch_text_(text_of(arch)),
      arch_(least(parse_arch(arch_text_, arch))),
      base_(machine_setup(scene_, arch_)),
      census_(base_.plan, base_.initial),
      loads_(base_.plan, census_),
      room_(room_of(target)) {
  arch_ = base_.plan.arch;  // with what was automatic
  if (base_.plan.program != nullptr) {
    check_emission(base_.plan, {.board = board_});
    rule_memories_ = memories_of(base_.plan);
  } else {
    memories_.emplace(base_.plan.rule, base_.plan.arch, base_.plan.particles);
  }
  if (!arch_.narrow_memories) with_choice(arch_text_, arch, {{1, 1, 1}, 1, 1});  // can take a choice
}

Plan Fitter::plan_at(const FitPoint& point) const {
  Arch arch = arch_;
  arch.brick = point.brick;
  arch.filter_lanes = point.lanes;
  arch.force_pipes = point.pipes;
  return on_machine(base_.plan, std::move(arch));
}

FitAmounts Fitter::memories(const Cell& brick, int lanes, int pipes, Family family) {
  if (arch_.narrow_memories) return {};
  if (base_.plan.program != nullptr) {
    Counts counts;
    for (const NodeMemory& m : rule_memories_) counts += memory_counts(family, m);
    return amounts_of(counts);
  }
  const auto count = [&](int of_pipes) {
    Counts counts;
    for (const NodeMemory& m : memories_->of(brick, lanes, of_pipes)) counts += memory_counts(family, m);
    return amounts_of(counts);
  };
  if (family != target_.family) return count(pipes);
  const auto [found, is_new] = memory_amounts_.try_emplace({brick, lanes});
  auto& [one, more] = found->second;
  if (is_new) {
    one = count(1);
    more = count(2);
    for (size_t r = 0; r < one.size(); ++r) more[r] -= one[r];
  }
  FitAmounts amounts = one;
  for (size_t r = 0; r < amounts.size(); ++r) amounts[r] += more[r] * static_cast<uint64_t>(pipes - 1);
  return amounts;
}

FitAmounts Fitter::estimate(const FitShape& shape, int lanes, int pipes) {
  const FitPoint point{shape.brick, lanes, pipes};
  if (const auto known = measured_.find(point); known != measured_.end()) return known->second;
  FitAmounts all =
      times(model_.predict(point, memories(shape.brick, lanes, pipes, target_.family)), shape.nodes);
  for (size_t r = 0; r < all.size(); ++r) all[r] += static_cast<uint64_t>(around_[r] * shape.nodes);
  return all;
}

// If the memories alone do not fit, only they are reported; logic is not estimated. The search asks for very
// many points.
FitAmounts Fitter::uses(const FitShape& shape, int lanes, int pipes) {
  const FitAmounts least = times(memories(shape.brick, lanes, pipes, target_.family), shape.nodes);
  return has_room(least, room_) || measured({shape.brick, lanes, pipes}) ? estimate(shape, lanes, pipes)
                                                                         : least;
}

std::optional<uint64_t> Fitter::cycles(const FitPoint& point) {
  if (interrupted()) throw Interrupted();
  const auto [found, is_new] = cycles_.try_emplace(point);
  if (is_new) {
    try {
      const Plan plan = plan_at(point);
      found->second = arch_.narrow_memories ? expected_cycles(plan, base_.initial).step
                                            : expected_cycles(plan, census_).step;
    } catch (const InputError&) {
      // Too many visits for a node, or a ring that this brick cannot cut.
    }
  }
  return found->second;
}

FitCosts Fitter::costs() {
  return {[this](const FitShape& s, int lanes, int pipes) { return uses(s, lanes, pipes); },
          [this](const FitShape& s, int lanes, int pipes) {
            return arch_.narrow_memories ? 0 : loads_.least_cycles(s.brick, lanes, pipes);
          },
          [this](const FitShape& s, int lanes, int pipes) {
            return cycles({s.brick, lanes, pipes});
          }};
}

// Whether the memories of so many nodes, of the fewest lanes and pipes, find room.
bool Fitter::fit_memories(const Target& target, const Cell& brick, uint64_t nodes) {
  return has_room(times(memories(brick, 1, 1, target.family), nodes), room_of(target));
}

// Shapes without room for their memories are not looked at.
void Fitter::find_shapes() {
  const Lattice& lattice = base_.plan.lattice;
  space_ = {};
  if (arch_.narrow_memories) {
    space_.shapes = {{{1, 1, 1}, lattice.size()}};
    return;
  }
  space_.most_lanes = space_.most_pipes = std::min(64, fullest(census_, lattice.size()));
  for (const Cell& brick : possible_bricks(lattice)) {
    const uint64_t cells = cells_of(brick);
    if (cells > 1 && (one_cell() || !no_bricks_.empty())) break;
    if (!fit_memories(target_, brick, (lattice.size() + cells - 1) / cells)) continue;
    const uint32_t nodes = count_bricks(lattice, brick);
    if (fit_memories(target_, brick, nodes)) space_.shapes.push_back({brick, nodes});
  }
}

void Fitter::measure(const FitPoint& point) {
  if (measured(point)) return;
  if (interrupted()) throw Interrupted();
  at_work_ =
      fmt::format("synthesises nodes of {} x {} x {} cells, {} lanes, {} pipes ({} done)", point.brick[0],
                  point.brick[1], point.brick[2], point.lanes, point.pipes, measured_.size());
  says_(at_work_);
  const Plan plan = plan_at(point);
  const auto begin = Clock::now();
  const Measured m = meter_.measure(
      [&](const std::string& directory) {
        try {
          emit_rtl(plan, base_.initial, directory, {.board = board_});
        } catch (const InputError& error) {
          throw NotEmitted(error);
        }
      },
      !board_.name.empty(), plan.nodes() == 1 ? Nodes::flat : Nodes::apart);
  const FitAmounts node = amounts_of(m.node), around = amounts_of(m.around);
  model_.add(point, memories(point.brick, point.lanes, point.pipes, target_.family), node);
  FitAmounts& all = measured_[point] = times(node, m.nodes);
  for (size_t r = 0; r < all.size(); ++r) {
    all[r] += around[r];
    around_[r] = static_cast<double>(around[r]) / static_cast<double>(m.nodes);
  }
  const double seconds = seconds_since(begin);
  if (!m.kept) ++syntheses_, seconds_ += seconds;
  if (announced_) tells_(line_of(point, m.kept, seconds));
}

// Before the first tool: how long a synthesis takes is not known before one was made.
void Fitter::announce() {
  if (announced_) return;
  announced_ = true;
  std::string line =
      single() ? "one synthesis: seconds for a small node, minutes for a large one"
               : fmt::format("3 to {} syntheses, each of seconds for small nodes and minutes for large ones",
                             kMostSyntheses + 2);
  if (!measured_.empty()) line += fmt::format("; {} known from before", measured_.size());
  tells_(line);
}

std::string Fitter::kept() const { return syntheses_ == 0 ? "" : meter_.kept(); }

void Fitter::choose() {
  says_("looks for bricks");
  find_shapes();
  choice_ = fastest_that_fits(space_, room_, costs());
  std::array<bool, 2> drawn{};  // lines of nodes of one cell, of bricks
  while (choice_) {
    const FitPoint point = choice_->point;
    if (measured(point)) break;
    bool& lines = drawn[cells_of(point.brick) > 1];
    try {
      if (!lines) {
        const int many = std::min(kManyLanes, space_.most_lanes);
        for (const FitPoint& p : {FitPoint{point.brick, 1, 1}, FitPoint{point.brick, many, 1},
                                  FitPoint{point.brick, many, std::min(2, many)}})
          measure(p);
        lines = true;
      } else if (measured_.size() >= kMostSyntheses) {
        // Only what was measured counts from here on.
        FitCosts known = costs();
        known.uses = [this](const FitShape& s, int lanes, int pipes) {
          const auto found = measured_.find({s.brick, lanes, pipes});
          return found == measured_.end() ? FitAmounts{UINT64_MAX, 0, 0, 0, 0} : found->second;
        };
        choice_ = fastest_that_fits(space_, room_, known);
        break;
      } else {
        estimates_[point] = choice_->uses;
        measure(point);
      }
    } catch (const NotEmitted& error) {
      if (cells_of(point.brick) == 1) throw;
      refused_[point.brick] = error.what();
      if (refused_.size() >= kMostRefused) no_bricks_ = error.what();
      std::erase_if(space_.shapes, [&](const FitShape& s) {
        return cells_of(s.brick) > 1 && (!no_bricks_.empty() || s.brick == point.brick);
      });
    }
    choice_ = fastest_that_fits(space_, room_, costs());
  }
  if (!choice_) refuse();
}

std::string Fitter::arch_text() const {
  std::string text = arch_.narrow_memories ? arch_text_ : with_choice(arch_text_, arch_path_, choice_->point);
  if (text.starts_with(kHeading)) text.erase(0, text.find('\n') + 1);  // of an earlier choice
  return fmt::format("{}{} chose them.\n{}", kHeading, target_.name, text);
}

Setup Fitter::setup() const { return machine_setup(scene_, parse_arch(arch_text(), "arch.toml")); }

}  // namespace cuboct::synth
