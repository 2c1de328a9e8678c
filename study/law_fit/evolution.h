// SPDX-License-Identifier: MIT
// CMA-ES (pagmo) that is asked for a generation and then told what its samples are worth.
#pragma once

#include <memory>
#include <vector>

namespace cuboct::fit {

// What the module with pagmo makes. pagmo takes 34 MB and 20 ms to load: a fit alone loads it.
class Generations {
 public:
  virtual ~Generations() = default;
  virtual std::vector<std::vector<double>> ask() const = 0;
  virtual void tell(const std::vector<double>& losses) = 0;
};
// The arguments are Evolution's; the caller owns what it gets.
using MakeGenerations = Generations*(const std::vector<double>& start, double start_loss, unsigned samples,
                                     double spread, unsigned seed);
inline constexpr const char* kEvolutionModule = "cuboct-evolution.so";
inline constexpr const char* kMakeGenerations = "cuboct_make_generations";

// N. Hansen, The CMA evolution strategy: a comparing review (2006). The same calls give the same samples to
// the last bit.
class Evolution {
 public:
  // Samples scatter about `start`, all of whose components are in [0, 1], by `spread` along each axis.
  // 5 `samples` or more. InputError where the module is missing.
  Evolution(const std::vector<double>& start, double start_loss, unsigned samples, double spread,
            unsigned seed);

  // The next generation. Its components leave [0, 1]: clipped samples would spoil the covariance.
  std::vector<std::vector<double>> ask() const { return generations_->ask(); }
  // Their losses, in this order.
  void tell(const std::vector<double>& losses) { generations_->tell(losses); }

 private:
  std::unique_ptr<Generations> generations_;
};

}  // namespace cuboct::fit
