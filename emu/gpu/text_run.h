// SPDX-License-Identifier: MIT
// A rule that is text, in floats or doubles on a GPU, behind the interface of all engines. The device makes
// the steps, forces and fields. The reference tells a state's energies and damage where those are asked for.
#pragma once

#include <memory>
#include <optional>

#include "emu/gpu/rounds/real_rounds_engine.h"
#include "emu/gpu/run.h"
#include "model/run/rounds_run.h"

namespace cuboct::gpu {

class TextRun final : public RoundsRun {
 public:
  // Keeps references to `scene` and `choice`. `from`: a checkpoint; null: `scene`'s body.
  static std::unique_ptr<TextRun> make(const Scene& scene, double cell_edge, const GpuChoice& choice,
                                       CheckpointReader* from);

  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  double largest_speed() override;
  cuboct::Counters counters() override;
  Notes notes() override { return notes_; }
  EngineMemory memory() override;

 private:
  TextRun(const Scene& scene, const Body& body, double cell_edge, const GpuChoice& choice,
          const Memory& memory);
  void renew() override;
  void follow(RealEngine& reference) override;
  std::vector<Vec3> forces() override;
  std::vector<std::vector<double>> fields() override;
  const RealLook& look();
  // Why the next step is none: in the reference's words where it is none for it, too.
  [[noreturn]] void tell(const std::string& why);

  const GpuChoice& choice_;
  double cell_edge_, fastest_ = 0;  // m; m/s, along an axis, of the states that were looked at
  std::unique_ptr<RealRounds> device_;
  std::optional<RealLook> look_;  // of body()
  Notes notes_;
};

}  // namespace cuboct::gpu
