// SPDX-License-Identifier: MIT
// A rule that is text, in floats or doubles on a GPU, behind the interface of all engines. The device makes
// the steps, forces and fields. What else is asked of a state, such as its energies, the reference tells of
// it.
#pragma once

#include <memory>

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
  RunState frame(bool forces) override;
  double largest_speed() override;
  cuboct::Counters counters() override;
  Notes notes() override { return notes_; }
  EngineMemory memory() override;

 private:
  TextRun(const Scene& scene, const Body& body, double cell_edge, const GpuChoice& choice,
          const Memory& memory);
  void renew() override;
  // Why the next step is none: in the reference's words where it is none for it, too.
  [[noreturn]] void tell(const std::string& why);

  const GpuChoice& choice_;
  double cell_edge_, fastest_ = 0;  // m; m/s, along an axis, of the states that were looked at
  std::unique_ptr<RealRounds> device_;
  Notes notes_;
};

}  // namespace cuboct::gpu
