// SPDX-License-Identifier: MIT
// The frames, curves and warnings of a run that a directory holds.
#pragma once

#include <deque>
#include <mutex>
#include <string>

#include "cli/run/outputs.h"
#include "cli/run/report_pictures.h"
#include "cli/view/machine.h"
#include "cli/view/source.h"
#include "model/trace/view_frame.h"

namespace cuboct {

class StoredRun : public ViewSource {
 public:
  // `every`: keeps each so-manieth frame, and the last. `particles`: at most so many of each. InputError
  // where the directory holds no run that is over.
  StoredRun(const std::string& directory, size_t every, size_t particles);

  // Of the frames those of these steps, which all are there; of them each so-manieth, and the last.
  void keep(const std::vector<uint64_t>& steps, size_t every);

  const std::string& directory() const { return directory_; }
  const Loaded& loaded() const { return loaded_; }
  const Trace& trace() const { return trace_; }
  bool real() const { return shots_.real(); }
  uint64_t step(size_t k) const { return shots_.step(chosen_[k]); }
  const State& state(size_t k) const { return trace_.frames[chosen_[k]]; }       // of the fixed rule
  const RealFrame& bodies(size_t k) const { return trace_.bodies[chosen_[k]]; }  // in real numbers

  std::string title() const;
  std::string left_out() const;  // of the frames; empty: none
  Story tell() const;            // without the frames
  Story told() const;            // with their bounds
  size_t frames() const { return chosen_.size(); }
  size_t particles() const { return loaded_.setup.plan.particles; }
  const ViewFrames& form() const { return form_; }
  ViewFrame frame(size_t k) const;
  const ViewMachine& machine() const { return machine_; }
  std::string held(size_t k) const { return machine_.held(*shots_.state(chosen_[k])); }
  // Of the steps whose phases were recorded those that begin with a frame, and that before the last one.
  std::vector<size_t> steps_of_frames() const;

  std::string story() override;
  std::string news(size_t, size_t) override;
  Bytes block(size_t frame, size_t block, std::optional<size_t> row) override;
  Bytes machine(const std::string& block, size_t k) override;
  bool command(const std::string&) override { return false; }

 private:
  Frame bare_frame(size_t k) const;  // places and velocities, of a frame of the trace
  std::shared_ptr<const ViewFrame> kept(size_t k);

  std::string directory_;
  RunRecord record_;
  Trace trace_;
  Loaded loaded_;
  Shots shots_;
  TraceHead head_;
  ViewFrames form_;
  ViewMachine machine_;
  std::vector<size_t> chosen_;  // of the trace's frames
  std::mutex guard_;            // of `made_`, and of making: a strain meter is built by the first frame
  std::deque<std::pair<size_t, std::shared_ptr<const ViewFrame>>>
      made_;  // the last few, as a page asks for each block by itself
};

}  // namespace cuboct
