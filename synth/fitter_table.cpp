// SPDX-License-Identifier: MIT
// What --fit says: the table of plans, or why none fits and what would.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "model/base/quantity_text.h"
#include "synth/fitter.h"

namespace cuboct::synth {
namespace {

// Rows on either side of the choice, by numbers of nodes.
constexpr size_t kShownAround = 4;
// Numbers of nodes that have no room for their memories.
constexpr size_t kShownWithoutRoom = 2;

std::string cells_text(const Cell& brick) {
  return fmt::format("{} x {} x {}", brick[0], brick[1], brick[2]);
}

// Of a device that has none of it, "-".
std::string share_text(uint64_t used, uint64_t holds) {
  if (holds == 0) return used == 0 ? "-" : std::to_string(used);
  return fmt::format("{:.0f} %", 100.0 * static_cast<double>(used) / static_cast<double>(holds));
}

uint64_t holds_of(const Target& target, Resource r) {
  return target.holds[r == Resource::cell ? Resource::lut : r];
}

bool shows(const Target& target, Resource r) { return r != Resource::cell || target.family == Family::ice40; }

}  // namespace

std::string Fitter::numbers(const FitAmounts& uses) const {
  std::string text;
  for (size_t r = 0; r < kFitted.size(); ++r)
    if (shows(target_, kFitted[r]) && uses[r] > 0)
      text += fmt::format("{}{} {}/{}", text.empty() ? "" : ", ", to_string(kFitted[r]), uses[r],
                          holds_of(target_, kFitted[r]));
  return text;
}

// The same, what is too much first.
std::string Fitter::excess(const FitAmounts& uses) const {
  std::string over, rest;
  for (size_t r = 0; r < kFitted.size(); ++r) {
    if (!shows(target_, kFitted[r]) || uses[r] == 0 || (kFitted[r] == Resource::cell && model_.empty()))
      continue;
    const bool much = uses[r] > room_[r];
    std::string& text = much ? over : rest;
    text += fmt::format("{}{} {}/{}", text.empty() ? "" : ", ", to_string(kFitted[r]), uses[r],
                        holds_of(target_, kFitted[r]));
    if (much && room_[r] > 0) {
      const double ratio = static_cast<double>(uses[r]) / static_cast<double>(room_[r]);
      text += fmt::format(" ({:.{}f} times)", ratio, ratio < 10 ? 2 : 0);
    }
  }
  return over.empty() || rest.empty() ? over + rest : over + ", " + rest;
}

std::string Fitter::verdict(const FitAmounts& uses) const {
  if (has_room(uses, room_)) return "fits";
  const size_t r = worst_share(uses, room_).resource;
  const double planned = planned_share(target_, kFitted[r]);
  return fmt::format("no: {} {}{}", to_string(kFitted[r]), share_text(uses[r], holds_of(target_, kFitted[r])),
                     planned < 1 ? fmt::format(", planned to {:.0f} %", 100 * planned) : "");
}

// Of one that was synthesised. What may be left is the mean of those that were, times the most that may come.
std::string Fitter::line_of(const FitPoint& point, bool known, double seconds) const {
  const FitAmounts& all = measured_.at(point);
  std::string line = fmt::format("{}: {} cells a node, {}, {}: {}, {}", measured_.size(),
                                 cells_text(point.brick), counted(static_cast<uint64_t>(point.lanes), "lane"),
                                 counted(static_cast<uint64_t>(point.pipes), "pipe"),
                                 known ? "known" : fmt::format("{:.0f} s", seconds), numbers(all));
  const size_t left = measured_.size() < kMostSyntheses ? kMostSyntheses - measured_.size() : 0;
  if (syntheses_ > 0 && left > 0 && !single())
    line += fmt::format("; {} more at most, of {:.0f} s each so far", left,
                        seconds_ / static_cast<double>(syntheses_));
  return line;
}

void Fitter::add_row(std::vector<Row>& rows, const std::optional<FitChoice>& plan) {
  if (plan && std::ranges::none_of(rows, [&](const Row& r) { return r.plan.point == plan->point; }))
    rows.push_back({*plan, plan->point == choice_->point});
}

std::string Fitter::table() {
  FitCosts cost = costs();
  cost.uses = [this](const FitShape& s, int lanes, int pipes) { return estimate(s, lanes, pipes); };
  std::vector<Row> rows;
  add_row(rows, choice_);
  // The best of each number of nodes around the choice's.
  std::set<uint32_t> counts;
  for (const FitShape& s : space_.shapes) counts.insert(s.nodes);
  std::vector<uint32_t> shown;
  const auto here = counts.find(choice_->nodes);
  auto below = here;
  for (size_t k = 0; k < kShownAround && below != counts.begin(); ++k) shown.push_back(*--below);
  auto above = std::next(here);
  for (size_t k = 0; k < kShownAround && above != counts.end(); ++k) shown.push_back(*above++);
  for (const uint32_t nodes : shown) {
    FitSpace same = space_;
    std::erase_if(same.shapes, [&](const FitShape& s) { return s.nodes != nodes; });
    const auto fitting = fastest_that_fits(same, room_, cost);
    add_row(rows, fitting ? fitting : nearest_to_fit(same, room_, cost));
  }
  // More nodes, whose memories have no room: the nearest of each number. A brick of so many cells makes no
  // fewer nodes than this, so that few have to be counted.
  const auto least_nodes = [size = base_.plan.lattice.size()](const Cell& b) {
    return (size + cells_of(b) - 1) / cells_of(b);
  };
  std::vector<Cell> bricks;
  if (!one_cell()) bricks = possible_bricks(base_.plan.lattice);
  std::ranges::stable_sort(bricks, {}, least_nodes);
  std::map<uint32_t, FitSpace> without_room;
  for (const Cell& brick : bricks) {
    if (without_room.size() > kShownWithoutRoom) without_room.erase(std::prev(without_room.end()));
    if (without_room.size() == kShownWithoutRoom && least_nodes(brick) > without_room.rbegin()->first) break;
    const bool known = std::ranges::find(space_.shapes, brick, &FitShape::brick) != space_.shapes.end();
    const uint32_t nodes = known ? 0 : count_bricks(base_.plan.lattice, brick);
    if (nodes > choice_->nodes) without_room[nodes].shapes.push_back({brick, nodes});
  }
  size_t told = 0;
  for (auto& [nodes, space] : without_room) {
    if (++told > kShownWithoutRoom) break;
    // With the lanes and pipes of the choice, as fewer would be slow for another reason.
    const auto lanes = choice_->point.lanes, pipes = choice_->point.pipes;
    FitCosts same = cost;
    same.uses = [&](const FitShape& s, int, int) { return estimate(s, lanes, pipes); };
    same.cycles = [&](const FitShape& s, int, int) { return cycles({s.brick, lanes, pipes}); };
    auto nearest = nearest_to_fit(space, room_, same);
    if (nearest) nearest->point.lanes = lanes, nearest->point.pipes = pipes;
    add_row(rows, nearest);
  }
  // A lane more, a pipe more.
  const FitShape shape{choice_->point.brick, choice_->nodes};
  for (const auto& [lanes, pipes] : {std::pair{1, 0}, std::pair{0, 1}}) {
    const FitPoint p{shape.brick, choice_->point.lanes + lanes, choice_->point.pipes + pipes};
    if (p.lanes > space_.most_lanes || p.pipes > std::min(p.lanes, space_.most_pipes)) continue;
    if (const auto c = cycles(p))
      add_row(rows, FitChoice{p, shape.nodes, *c, estimate(shape, p.lanes, p.pipes)});
  }
  // Every plan that was synthesised.
  for (const auto& [point, all] : measured_) {
    const auto c = cycles(point);
    const auto s = std::ranges::find(space_.shapes, point.brick, &FitShape::brick);
    if (c && s != space_.shapes.end()) add_row(rows, FitChoice{point, s->nodes, *c, all});
  }
  std::ranges::sort(rows, {}, [](const Row& r) {
    return std::tuple{r.plan.cycles, r.plan.nodes, r.plan.point};
  });

  std::string text =
      fmt::format("  {:<14} {:>6} {:>6} {:>6} {:>13}", "brick", "nodes", "lanes", "pipes", "expected/step");
  for (const Resource r : kFitted)
    if (shows(target_, r)) text += fmt::format(" {:>{}}", to_string(r), r == Resource::cell ? 11 : 6);
  text += "\n";
  for (const Row& row : rows) {
    const FitChoice& p = row.plan;
    text += fmt::format("{} {:<14} {:>6} {:>6} {:>6} {:>13}", row.chosen ? ">" : " ",
                        cells_text(p.point.brick), p.nodes, p.point.lanes, p.point.pipes, p.cycles);
    for (size_t r = 0; r < kFitted.size(); ++r)
      if (shows(target_, kFitted[r]))
        text += fmt::format(" {:>{}}", share_text(p.uses[r], holds_of(target_, kFitted[r])),
                            kFitted[r] == Resource::cell ? 11 : 6);
    text += fmt::format("  {}{}\n", row.chosen ? "chosen" : verdict(p.uses),
                        measured(p.point) ? "" : ", estimated");
  }
  text += "\n";
  text += fmt::format("{:<16} {}\n", "device", target_.name + ", " + target_.device);
  text += fmt::format("{:<16} {}\n", "synthesised", numbers(choice_->uses));
  std::string errors;
  if (const auto estimate = estimates_.find(choice_->point); estimate != estimates_.end())
    for (size_t r = 0; r < kFitted.size(); ++r)
      if (shows(target_, kFitted[r]) && choice_->uses[r] > 0)
        errors += fmt::format(
            "{}{} {:+.1f} %", errors.empty() ? "" : ", ", to_string(kFitted[r]),
            100 * (static_cast<double>(estimate->second[r]) / static_cast<double>(choice_->uses[r]) - 1));
  if (!errors.empty()) text += fmt::format("{:<16} {}\n", "estimate's error", errors);
  if (arch_.narrow_memories)
    text += fmt::format("{:<16} {}\n", "note", "memories = \"narrow\" have one lane, one pipe and no bricks");
  if (base_.plan.program != nullptr)
    text += fmt::format("{:<16} {}\n", "note", "nodes of a rule of text have one cell");
  if (!no_bricks_.empty())
    text +=
        fmt::format("{:<16} {}\n", "note", "without bricks: " + no_bricks_.substr(0, no_bricks_.find('\n')));
  return text;
}

// The least FPGA whose room the numbers of this one's synthesis do not exceed; of the memories as that one
// has them.
const Target* Fitter::other_device() {
  const Lattice& lattice = base_.plan.lattice;
  std::vector<const Target*> others;
  for (const Target& t : targets())
    if (t.family != Family::asic && t.name != target_.name) others.push_back(&t);
  // Numbers of the same family first: those of another one are nearly these.
  std::ranges::stable_sort(others, {}, [&](const Target* t) {
    return std::pair{t->family != target_.family, t->holds[Resource::lut]};
  });
  const auto fits = [&](const Target& t, const Cell& brick, uint64_t nodes) {
    const FitAmounts own = memories(brick, 1, 1, t.family);
    FitAmounts all = times(model_.predict({brick, 1, 1}, own), nodes);
    if (t.family != Family::ice40) all[4] = 0;
    return has_room(all, room_of(t));
  };
  std::vector<Cell> bricks =
      one_cell() || !no_bricks_.empty() ? std::vector<Cell>{{1, 1, 1}} : possible_bricks(lattice);
  for (const Target* t : others)
    for (const Cell& brick : bricks)
      if (fits(*t, brick, (lattice.size() + cells_of(brick) - 1) / cells_of(brick)) &&
          fits(*t, brick, count_bricks(lattice, brick)))
        return t;
  return nullptr;
}

// Of so many nodes with one lane and one pipe.
FitAmounts Fitter::least_uses(const Cell& brick, uint64_t nodes) {
  if (const auto known = measured_.find({brick, 1, 1}); known != measured_.end()) return known->second;
  FitAmounts all = times(model_.predict({brick, 1, 1}, memories(brick, 1, 1, target_.family)), nodes);
  for (size_t r = 0; r < all.size(); ++r)
    all[r] += static_cast<uint64_t>(around_[r] * static_cast<double>(nodes));
  return all;
}

// The most cells that the device has room for, in bricks of any shape, with one lane and one pipe.
uint64_t Fitter::cells_that_fit() {
  const bool flat = base_.plan.rule.axes == 2, single = one_cell() || !no_bricks_.empty();
  uint64_t most = 0;
  for (int32_t z = 1; z <= (flat || single ? 1 : kMostBrickCells); ++z)
    for (int32_t y = z; y * z <= (single ? 1 : kMostBrickCells); ++y)
      for (int32_t x = y; x * y * z <= (single ? 1 : kMostBrickCells); ++x) {
        const Cell brick{x, y, z};
        const FitAmounts node = model_.predict({brick, 1, 1}, memories(brick, 1, 1, target_.family));
        uint64_t nodes = UINT64_MAX;
        for (size_t r = 0; r < node.size(); ++r) {
          const double each = static_cast<double>(node[r]) + around_[r];
          if (each > 0) nodes = std::min(nodes, static_cast<uint64_t>(static_cast<double>(room_[r]) / each));
        }
        if (nodes != UINT64_MAX) most = std::max(most, nodes * cells_of(brick));
      }
  return most;
}

void Fitter::refuse() {
  const Lattice& lattice = base_.plan.lattice;
  if (measured_.size() >= kMostSyntheses) {
    const auto& [point, uses] = *std::ranges::min_element(
        measured_, {}, [this](const auto& m) { return worst_share(m.second, room_).share; });
    throw InputError(fmt::format("{}: none of the {} plans for {} that were synthesised fits; the nearest, "
                                 "nodes of {} cells with {} and {}, takes {}",
                                 scene_path_, measured_.size(), target_.name, cells_text(point.brick),
                                 counted(static_cast<uint64_t>(point.lanes), "lane"),
                                 counted(static_cast<uint64_t>(point.pipes), "pipe"), excess(uses)),
                     "each was estimated to fit, so the device is nearly full: give a shorter node.capacity "
                     "or node.queue_depth, or a larger device");
  }
  // By the least number of nodes, which no count is below; counted until none of the rest can be nearer.
  std::vector<std::pair<double, Cell>> bricks;
  for (const Cell& brick : possible_bricks(lattice)) {
    if (cells_of(brick) > 1 && (one_cell() || !no_bricks_.empty())) break;
    const uint64_t nodes = (lattice.size() + cells_of(brick) - 1) / cells_of(brick);
    bricks.emplace_back(worst_share(least_uses(brick, nodes), room_).share, brick);
  }
  std::ranges::stable_sort(bricks, {}, &std::pair<double, Cell>::first);
  FitShape shape;
  FitAmounts used;
  double share = std::numeric_limits<double>::infinity();
  for (const auto& [bound, brick] : bricks) {
    if (bound >= share) break;
    const uint32_t nodes = count_bricks(lattice, brick);
    const FitAmounts uses = least_uses(brick, nodes);
    if (const double here = worst_share(uses, room_).share; here < share || shape.nodes == 0) {
      share = here;
      shape = {brick, nodes};
      used = uses;
    }
  }
  const std::string what = fmt::format(
      "{}: its {} do not fit {}{}: the nearest plan, {} of {} cells with 1 lane and 1 pipe, takes {}{}",
      scene_path_, counted(lattice.size(), "cell"), target_.name,
      arch_.narrow_memories ? " with narrow memories" : "", counted(shape.nodes, "node"),
      cells_text(shape.brick), excess(used), model_.empty() ? ", for its memories alone" : "");
  std::string hint;
  if (const Target* other = other_device())
    hint =
        fmt::format("--fit {} has room {}", other->name, model_.empty() ? "for these" : "by these numbers");
  else
    hint =
        fmt::format("no device that is known has room {}", model_.empty() ? "for these" : "by these numbers");
  const uint64_t cells = cells_that_fit();
  hint += cells == 0
              ? fmt::format("; not one cell fits {}", target_.name)
              : fmt::format(
                    "; about {} would fit {}, some {} of this scene", counted(cells, "cell"), target_.name,
                    counted(std::max<uint64_t>(
                                1, static_cast<uint64_t>(std::llround(
                                       static_cast<double>(cells) * base_.plan.particles / lattice.size()))),
                            "particle"));
  if (const int most = fullest(census_, lattice.size()); 2 * most <= arch_.capacity && !arch_.narrow_memories)
    hint +=
        fmt::format("; the fullest cell holds {} at the start, node.capacity is {}", most, arch_.capacity);
  if (arch_.narrow_memories) hint += "; memories = \"wide\" have bricks";
  if (!no_bricks_.empty()) hint += "; without bricks: " + no_bricks_.substr(0, no_bricks_.find('\n'));
  throw InputError(what, hint);
}

}  // namespace cuboct::synth
