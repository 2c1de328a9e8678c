// SPDX-License-Identifier: MIT
// The trace of a run in the making, on disk: hashes, frames, samples and cycles are appended as they come and
// never written again. A checkpoint says how far the journal holds.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/run/engine.h"
#include "model/run/word_file.h"

namespace cuboct {

// Six words per particle, nine where the rule holds particles by force:
//   id, cell (32 bits each)   x, y   z, type   v_x v_y v_z   [u_x u_y u_z]
void put(WordWriter& out, const Particle& particle, bool displaced);
Particle take_particle(WordReader& in, bool displaced);

// In real numbers, by id: x_x x_y x_z   v_x v_y v_z   [u_x u_y u_z]; types stay.
void put(WordWriter& out, const std::vector<Vec3>& x, const std::vector<Vec3>& v, const std::vector<Vec3>& u);
void take_body(WordReader& in, size_t particles, bool displaced, Body& body);

class Journal {
 public:
  // Begins a new one; InputError where another run has it open.
  Journal(const std::string& path, uint64_t plan_hash, bool displaced);
  // Goes on behind `end`, whose words are read into `trace` (without frames, curves without names: curve k's
  // samples are those of `curves[k]`). Throws InputError where the file is not that of the plan, or is
  // damaged.
  Journal(const std::string& path, uint64_t plan_hash, bool displaced, const WordMark& end, Trace& trace);

  void hash(uint64_t step, uint64_t hash);
  void sample(uint64_t step, std::span<const double> values);  // of each curve, later of the first ones
  void cycles(uint64_t step, std::span<const PhaseSpan> spans);
  void frame(const RunState& state);

  // All of the above is on the disk when it returns.
  WordMark sync();

  const std::vector<uint64_t>& frame_steps() const { return frame_steps_; }
  void for_each_frame(const std::function<void(RunState)>& see);  // read back

 private:
  void head(uint64_t kind, uint64_t step, uint64_t words);

  std::string path_;
  bool displaced_;
  std::vector<uint64_t> frame_steps_, frame_places_;  // where each frame's head lies
  std::unique_ptr<WordWriter> out_;
};

}  // namespace cuboct
