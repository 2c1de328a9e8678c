// SPDX-License-Identifier: MIT
// `cuboct emit --fit`: the brick, lanes and pipes with which a whole scene fits a device and takes the fewest
// cycles. docs/reference/synth.md, "Fitting a device".
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hw/cost/node_memories.h"
#include "hw/cost/room_search.h"
#include "hw/plan/setup.h"
#include "hw/rtl/board.h"
#include "synth/fit_measure.h"
#include "synth/fit_model.h"

namespace cuboct::synth {

// Throws InputError where nothing can be fitted to `target`: an unknown one, standard cells, another device
// than the board's.
const Target& fit_target(const std::string& target, const BoardChoice& board);

// Particles in the cell that has most, at least 1.
int fullest(const PairCensus& census, uint32_t cells);

// Syntheses after which the best that was measured has to do. Two more are made where the sixteenth is the
// first node of another kind, which takes three.
inline constexpr size_t kMostSyntheses = 16;

class Fitter {
 public:
  // Reads scene and arch. Throws InputError; a tool that is missing is told first.
  // `says` hears what it does next. `tells` hears a line before the first synthesis, and one after each, with
  // its seconds.
  Fitter(const std::string& scene, const std::string& arch, const Target& target, const BoardChoice& board,
         std::function<void(const std::string& what)> says,
         std::function<void(const std::string& line)> tells);
  Fitter(const Fitter&) = delete;  // meter_ tells this one
  Fitter& operator=(const Fitter&) = delete;

  // Searches, measures, and searches again until the best plan is one that was measured. Throws InputError
  // with the numbers of the nearest where none fits, ToolFailed, Interrupted.
  void choose();

  // What was considered, the choice marked.
  std::string table();
  // The arch with the choice made, its other text as it was.
  std::string arch_text() const;
  Setup setup() const;
  uint64_t steps() const { return scene_.steps; }  // of the scene's run
  // Where another search finds what this one measured: empty where it kept nothing, as there is no cache, or
  // nothing was measured yet.
  std::string kept() const;

 private:
  struct Row {
    FitChoice plan;
    bool chosen = false;
  };

  Plan plan_at(const FitPoint& point) const;
  // Of a rule of text those of one lane and one pipe: what more lanes and pipes add is measured.
  FitAmounts memories(const Cell& brick, int lanes, int pipes, Family family);
  // One cell a node, as narrow memories and rules of text have it.
  bool one_cell() const { return arch_.narrow_memories || base_.plan.program != nullptr; }
  FitAmounts estimate(const FitShape& shape, int lanes, int pipes);
  FitAmounts uses(const FitShape& shape, int lanes, int pipes);
  std::optional<uint64_t> cycles(const FitPoint& point);
  FitCosts costs();
  void find_shapes();
  void measure(const FitPoint& point);
  // Whether there is one plan alone to measure.
  bool single() const { return space_.shapes.size() == 1 && space_.most_lanes == 1; }
  void announce();
  std::string line_of(const FitPoint& point, bool known, double seconds) const;
  bool measured(const FitPoint& point) const { return measured_.contains(point); }
  FitAmounts least_uses(const Cell& brick, uint64_t nodes);
  bool fit_memories(const Target& target, const Cell& brick, uint64_t nodes);
  // No plan of the space fits.
  [[noreturn]] void refuse();
  const Target* other_device();
  uint64_t cells_that_fit();
  void add_row(std::vector<Row>& rows, const std::optional<FitChoice>& plan);
  std::string numbers(const FitAmounts& uses) const;
  std::string excess(const FitAmounts& uses) const;
  std::string verdict(const FitAmounts& uses) const;

  std::string scene_path_, arch_path_;
  const Target& target_;
  BoardChoice board_;
  std::function<void(const std::string&)> says_, tells_;
  size_t syntheses_ = 0;  // made here, not found in the cache
  double seconds_ = 0;    // that these took
  bool announced_ = false;
  std::string at_work_;  // what is being synthesised
  Meter meter_;
  Scene scene_;
  std::string arch_text_;
  Arch arch_;  // one cell, lane and pipe
  Setup base_;
  PairCensus census_;
  FitLoads loads_;
  std::optional<NodeMemories> memories_;   // of the pair law
  std::vector<NodeMemory> rule_memories_;  // of a rule of text
  FitAmounts room_;
  FitSpace space_;
  FitModel model_;
  std::map<FitPoint, FitAmounts> measured_;                                   // whole
  std::array<double, 5> around_{};                                            // per node, as last measured
  std::map<std::pair<Cell, int>, std::array<FitAmounts, 2>> memory_amounts_;  // of one pipe, of each more
  std::map<FitPoint, std::optional<uint64_t>> cycles_;
  std::map<Cell, std::string> refused_;  // bricks that cannot be emitted, and why
  std::string no_bricks_;                // why none can
  std::optional<FitChoice> choice_;
  std::map<FitPoint, FitAmounts>
      estimates_;  // of what was measured after the lines were drawn, before it was
};

}  // namespace cuboct::synth
