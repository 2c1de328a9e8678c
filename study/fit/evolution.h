// SPDX-License-Identifier: MIT
// CMA-ES (pagmo) that is asked for a generation and then told what its samples are worth.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace cuboct::fit {

// N. Hansen, The CMA evolution strategy: a comparing review (2006). The same calls give the same samples to
// the last bit.
class Evolution {
 public:
  // Samples scatter about `start`, all of whose components are in [0, 1], by `spread` along each axis.
  // 5 `samples` or more.
  Evolution(const std::vector<double>& start, double start_loss, unsigned samples, double spread,
            unsigned seed);
  ~Evolution();
  Evolution(const Evolution&) = delete;
  Evolution& operator=(const Evolution&) = delete;

  // The next generation. Its components leave [0, 1]: clipped samples would spoil the covariance.
  std::vector<std::vector<double>> ask() const;
  // Their losses, in this order.
  void tell(const std::vector<double>& losses);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cuboct::fit
