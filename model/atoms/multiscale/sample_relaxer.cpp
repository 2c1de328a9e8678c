// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/sample_relaxer.h"

#include <algorithm>
#include <utility>

#include "model/base/parallel.h"

namespace cuboct {
namespace {

constexpr size_t kSamplesAtOnce = 8;  // samples that a thread takes at a time

class HostRelaxer final : public SampleRelaxer {
 public:
  HostRelaxer(const SampleMaterial& material, size_t samples, int threads)
      : how_(material.relaxation), places_(samples, material.lattice.place) {
    for (int t = 0; t < threads; ++t) forces_.push_back(material.law->forces());
  }

  void relax(std::span<const StrainedSample> due, std::span<SampleAnswer> answers) override {
    const size_t parts = (due.size() + kSamplesAtOnce - 1) / kSamplesAtOnce;
    for_each_part(parts, static_cast<int>(forces_.size()), [&](size_t part, int member) {
      for (size_t k = part * kSamplesAtOnce; k < std::min(due.size(), (part + 1) * kSamplesAtOnce); ++k)
        answers[k] =
            relax_sample(*forces_[static_cast<size_t>(member)], due[k].cell, places_[due[k].sample], how_);
    });
  }
  Places places() const override { return places_; }
  void set_places(Places places) override { places_ = std::move(places); }

 private:
  Relaxation how_;
  Places places_;
  std::vector<std::unique_ptr<AtomicForces>> forces_;  // of each thread
};

}  // namespace

RelaxerMaker host_relaxer(int threads) {
  return [threads](const SampleMaterial& material, size_t samples) {
    return std::make_unique<HostRelaxer>(material, samples, threads);
  };
}

}  // namespace cuboct
