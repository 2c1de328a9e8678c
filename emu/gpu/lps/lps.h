// SPDX-License-Identifier: MIT
// The linear peridynamic solid on a device, in floats or doubles: the rounds, the bonds' damage and the step
// of the reference engine (semi-implicit Euler), by the same source of a bond, model/rules/lps_bond.h.
// docs/reference/peridynamics.md, "On a GPU".
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "model/contract/rule.h"
#include "model/rules/lps_terms.h"

namespace cuboct::gpu {

struct LpsOptions {
  bool doubles = false;
  int device = 0;
  int block = 128;  // threads
};

struct LpsState {
  std::vector<Vec3> x, v;  // m, m/s, by id
  std::vector<double> dilatation;
};

class LpsDevice {
 public:
  virtual ~LpsDevice() = default;
  // The body as it was given, with all its bonds.
  virtual void start() = 0;
  // Returns when the steps are done. std::runtime_error, naming a step and a particle, where a position is no
  // number any more.
  virtual void advance(uint64_t steps) = 0;
  virtual uint64_t step_count() const = 0;
  virtual LpsState state() = 0;
  // Of each particle's bonds the share that is broken, 0 to 1.
  virtual std::vector<double> damage() = 0;
  // What RoundsTerms::recall of the same body takes: [bond], the largest stretch so far.
  virtual std::vector<uint64_t> memory() = 0;
  virtual size_t kinds() const = 0;           // of bonds, by what they hold and never change
  virtual uint64_t device_bytes() const = 0;  // of the device's memory
};

// `body`: as it begins; `terms`: of the body as packed, `packed`. InputError where the rule has what devices
// have not: the free-surface correction, constraints by force; or where the device's memory is too small.
std::unique_ptr<LpsDevice> make_lps_device(const Rule& rule, const Body& body,
                                           const std::vector<Vec3>& packed, const LpsTerms& terms,
                                           const LpsOptions& options = {});

}  // namespace cuboct::gpu
