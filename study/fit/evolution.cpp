// SPDX-License-Identifier: MIT
// pagmo's cmaes draws a whole generation, then calls the fitness of one sample after the other. So a copy of
// algorithm and population runs a generation first, for its samples alone; the originals follow once all
// losses are known.
#include "study/fit/evolution.h"

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <stdexcept>
#include <utility>

namespace cuboct::fit {
namespace {

using Points = std::vector<pagmo::vector_double>;

// What a fitness reads and leaves; all copies of the problem share it.
struct Table {
  Points asked;
  const std::vector<double>* losses = nullptr;  // null: only asked for
};

struct Looked {
  size_t dimensions = 1;
  std::shared_ptr<Table> table = std::make_shared<Table>();

  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    const size_t at = table->asked.size();
    table->asked.push_back(x);
    return {table->losses ? table->losses->at(at) : 0.0};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    return {pagmo::vector_double(dimensions, 0.0), pagmo::vector_double(dimensions, 1.0)};
  }
};

}  // namespace

struct Evolution::State {
  std::shared_ptr<Table> table;
  pagmo::algorithm algorithm;
  pagmo::population population;
};

Evolution::Evolution(const std::vector<double>& start, double start_loss, unsigned samples, double spread,
                     unsigned seed) {
  const Looked problem{start.size()};
  // Defaults but for: one generation a call, no tolerances (which would end a generation), memory, bounds
  // not enforced.
  const pagmo::cmaes cmaes(1, -1, -1, -1, -1, spread, 0, 0, true, false, seed);
  state_ = std::make_unique<State>(
      State{problem.table, pagmo::algorithm(cmaes), pagmo::population(pagmo::problem(problem), 0, seed)});
  for (unsigned k = 0; k < samples; ++k) state_->population.push_back(start, {start_loss});
}
Evolution::~Evolution() = default;

std::vector<std::vector<double>> Evolution::ask() const {
  state_->table->asked.clear();
  state_->table->losses = nullptr;
  const pagmo::algorithm algorithm = state_->algorithm;
  algorithm.evolve(state_->population);
  return state_->table->asked;
}

void Evolution::tell(const std::vector<double>& losses) {
  const std::vector<std::vector<double>> asked = ask();
  if (losses.size() != asked.size()) throw std::logic_error("a loss for each sample");
  state_->table->asked.clear();
  state_->table->losses = &losses;
  state_->population = state_->algorithm.evolve(state_->population);
  state_->table->losses = nullptr;
  if (state_->table->asked != asked) throw std::logic_error("CMA-ES drew other samples than it told");
}

}  // namespace cuboct::fit
