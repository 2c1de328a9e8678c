// SPDX-License-Identifier: MIT
// `cuboct emit --fit`: the brick, lanes and pipes with which a whole scene fits a device and takes the fewest
// cycles. docs/reference/synth.md, "Fitting a device".
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "hw/board.h"
#include "hw/fit.h"
#include "hw/node_memories.h"
#include "synth/fit_measure.h"
#include "synth/fit_model.h"

namespace cuboct {

// Throws InputError where nothing can be fitted to `target`: an unknown one, standard cells, another device
// than the board's.
const synth::Target& fit_target(const std::string& target, const BoardChoice& board);

// Particles in the cell that has most, at least 1.
int fullest(const PairCensus& census, uint32_t cells);

// Syntheses after which the best that was measured has to do.
inline constexpr size_t kMostSyntheses = 16;

class Fitter {
 public:
  // Reads scene and arch. Throws InputError; a tool that is missing is told first.
  Fitter(const Input& input, const synth::Target& target, const BoardChoice& board);

  // Searches, measures, and searches again until the best plan is one that was measured. Throws InputError
  // with the numbers of the nearest where none fits, synth::ToolFailed, synth::Interrupted.
  void choose();

  // What was considered, the choice marked.
  std::string table();
  // The arch with the choice made, its other text as it was.
  std::string arch_text() const;
  Setup setup() const;

 private:
  struct Row {
    FitChoice plan;
    bool chosen = false;
  };

  Plan plan_at(const FitPoint& point) const;
  FitAmounts memories(const Cell& brick, int lanes, int pipes, synth::Family family);
  FitAmounts estimate(const FitShape& shape, int lanes, int pipes);
  FitAmounts uses(const FitShape& shape, int lanes, int pipes);
  std::optional<uint64_t> cycles(const FitPoint& point);
  FitCosts costs();
  void find_shapes();
  void measure(const FitPoint& point);
  bool measured(const FitPoint& point) const { return measured_.contains(point); }
  FitAmounts least_uses(const Cell& brick, uint64_t nodes);
  bool fit_memories(const synth::Target& target, const Cell& brick, uint64_t nodes);
  // No plan of the space fits.
  [[noreturn]] void refuse();
  const synth::Target* other_device();
  uint64_t cells_that_fit();
  void add_row(std::vector<Row>& rows, const std::optional<FitChoice>& plan);
  std::string numbers(const FitAmounts& uses) const;
  std::string excess(const FitAmounts& uses) const;
  std::string verdict(const FitAmounts& uses) const;

  Input input_;
  const synth::Target& target_;
  BoardChoice board_;
  synth::Meter meter_;
  Scene scene_;
  std::string arch_text_;
  Arch arch_;  // one cell, lane and pipe
  Setup base_;
  PairCensus census_;
  FitLoads loads_;
  NodeMemories memories_;
  FitAmounts room_;
  FitSpace space_;
  synth::FitModel model_;
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

}  // namespace cuboct
