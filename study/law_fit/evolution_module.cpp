// SPDX-License-Identifier: MIT
// pagmo's cmaes draws a whole generation, then calls the fitness of one sample after the other. So a copy of
// algorithm and population runs a generation first, for its samples alone; the originals follow once all
// losses are known.
#include "study/law_fit/evolution.h"

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

class Cmaes : public Generations {
 public:
  Cmaes(const std::vector<double>& start, double start_loss, unsigned samples, double spread, unsigned seed)
      : Cmaes(Looked{start.size()}, spread, seed) {
    for (unsigned k = 0; k < samples; ++k) population_.push_back(start, {start_loss});
  }

  std::vector<std::vector<double>> ask() const override {
    table_->asked.clear();
    table_->losses = nullptr;
    const pagmo::algorithm algorithm = algorithm_;
    algorithm.evolve(population_);
    return table_->asked;
  }

  void tell(const std::vector<double>& losses) override {
    const std::vector<std::vector<double>> asked = ask();
    if (losses.size() != asked.size()) throw std::logic_error("a loss for each sample");
    table_->asked.clear();
    table_->losses = &losses;
    population_ = algorithm_.evolve(population_);
    table_->losses = nullptr;
    if (table_->asked != asked) throw std::logic_error("CMA-ES drew other samples than it told");
  }

 private:
  // Defaults but for: one generation a call, no tolerances (which would end a generation), memory, bounds
  // not enforced.
  Cmaes(const Looked& problem, double spread, unsigned seed)
      : table_(problem.table),
        algorithm_(pagmo::cmaes(1, -1, -1, -1, -1, spread, 0, 0, true, false, seed)),
        population_(pagmo::problem(problem), 0, seed) {}

  std::shared_ptr<Table> table_;
  pagmo::algorithm algorithm_;
  pagmo::population population_;
};

}  // namespace

extern "C" Generations* cuboct_make_generations(const std::vector<double>& start, double start_loss,
                                                unsigned samples, double spread, unsigned seed) {
  return new Cmaes(start, start_loss, samples, spread, seed);
}

}  // namespace cuboct::fit
