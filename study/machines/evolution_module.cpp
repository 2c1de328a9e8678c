// SPDX-License-Identifier: MIT
// pagmo's NSGA-II over whole numbers; a generation's points are asked for together.
#include <cstddef>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/batch_evaluators/member_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>
#include <vector>

#include "study/machines/machine_evolution.h"

namespace cuboct::study {
namespace {

using Points = std::vector<std::vector<size_t>>;

// Axes of one notch are none to pagmo.
struct Space {
  const NotchEvolution* asked = nullptr;
  std::vector<size_t> free;  // axes

  std::vector<size_t> notches(const double* x) const {
    std::vector<size_t> at(asked->sizes.size(), 0);
    for (size_t k = 0; k < free.size(); ++k) at[free[k]] = static_cast<size_t>(x[k] + 0.5);
    return at;
  }
};

struct Machines {
  Space space;

  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    return space.asked->worth({space.notches(x.data())})[0];
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    pagmo::vector_double high;
    for (const size_t axis : space.free) high.push_back(static_cast<double>(space.asked->sizes[axis] - 1));
    return {pagmo::vector_double(high.size(), 0.0), high};
  }
  pagmo::vector_double::size_type get_nix() const { return space.free.size(); }
  pagmo::vector_double::size_type get_nobj() const { return space.asked->objectives; }
};

struct Together {
  Space space;

  pagmo::vector_double operator()(const pagmo::problem&, const pagmo::vector_double& xs) const {
    Points points;
    for (size_t at = 0; at < xs.size(); at += space.free.size()) points.push_back(space.notches(&xs[at]));
    pagmo::vector_double worth;
    for (const auto& one : space.asked->worth(points)) worth.insert(worth.end(), one.begin(), one.end());
    return worth;
  }
};

}  // namespace

extern "C" void cuboct_evolve_notches(const NotchEvolution& evolution) {
  Space space{&evolution, {}};
  for (size_t k = 0; k < evolution.sizes.size(); ++k)
    if (evolution.sizes[k] > 1) space.free.push_back(k);
  if (space.free.empty()) {
    evolution.worth({std::vector<size_t>(evolution.sizes.size(), 0)});
    return;
  }
  pagmo::population population(pagmo::problem(Machines{space}), 0, evolution.seed);
  pagmo::vector_double xs;
  for (unsigned k = 0; k < evolution.population; ++k) {
    const pagmo::vector_double x = population.random_decision_vector();
    xs.insert(xs.end(), x.begin(), x.end());
  }
  const pagmo::vector_double worth = Together{space}(population.get_problem(), xs);
  const auto part = [](const pagmo::vector_double& all, size_t k, size_t size) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(k * size);
    return pagmo::vector_double(from, from + static_cast<std::ptrdiff_t>(size));
  };
  for (unsigned k = 0; k < evolution.population; ++k)
    population.push_back(part(xs, k, space.free.size()), part(worth, k, evolution.objectives));
  // pagmo's own defaults but for the generations; a notch changes in one of so many.
  pagmo::nsga2 nsga2(evolution.generations, 0.95, 10, 1.0 / static_cast<double>(space.free.size()), 50,
                     evolution.seed);
  nsga2.set_bfe(pagmo::bfe(Together{space}));
  pagmo::algorithm(nsga2).evolve(population);
}

}  // namespace cuboct::study
