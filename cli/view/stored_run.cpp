// SPDX-License-Identifier: MIT
#include "cli/view/stored_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/run/summary.h"
#include "model/base/error.h"
#include "model/base/json.h"

namespace cuboct {
namespace {

constexpr size_t kKept = 3;  // frames

std::vector<size_t> chosen_of(size_t frames, size_t every) {
  std::vector<size_t> chosen;
  for (size_t k = 0; k < frames; k += every) chosen.push_back(k);
  if (frames > 0 && chosen.back() != frames - 1) chosen.push_back(frames - 1);
  return chosen;
}

}  // namespace

StoredRun::StoredRun(const std::string& directory, size_t every, size_t particles)
    : directory_(directory),
      record_(read_record(directory)),
      trace_(read_run(directory, record_)),
      loaded_(scene_of_run(directory, record_, trace_)),
      shots_(loaded_, trace_, directory + "/trace.h5"),
      head_(head_of(loaded_, shots_.real(), false)),
      form_(head_, frame_style(loaded_.scene), loaded_.setup.plan.particles, particles),
      machine_(loaded_, trace_, record_, shots_.real()),
      chosen_(chosen_of(shots_.size(), every)) {}

void StoredRun::keep(const std::vector<uint64_t>& steps, size_t every) {
  std::vector<size_t> there;
  for (size_t k = 0; k < shots_.size(); ++k)
    if (std::ranges::binary_search(steps, shots_.step(k))) there.push_back(k);
  chosen_.clear();
  for (const size_t k : chosen_of(there.size(), every)) chosen_.push_back(there[k]);
}

Frame StoredRun::bare_frame(size_t k) const {
  return shots_.real() ? frame_of(loaded_, trace_.bodies[k]) : frame_of(loaded_, trace_.frames[k]);
}

std::string StoredRun::title() const {
  return loaded_.scene.title.empty() ? record_.scene : loaded_.scene.title;
}

std::string StoredRun::left_out() const {
  return chosen_.size() < shots_.size() ? fmt::format("of the run's {}", shots_.size()) : "";
}

ViewFrame StoredRun::frame(size_t k) const {
  return form_.make(shots_.whole_frame(chosen_[k]), shots_.state(chosen_[k]));
}

Story StoredRun::tell() const {
  Story story{form_.head_json(trace_.engine), {}};
  story.curves = trace_.curves;
  for (const std::string& text : warnings_of(loaded_, shots_.real()))
    story.warnings.push_back("warning: " + text);
  for (const Finding& finding : trace_.findings) story.warnings.push_back("warning: " + finding.text);
  if (trace_.stop) story.warnings.push_back("stopped: " + trace_.stop->text);
  const Items facts = facts_of(loaded_, trace_);
  for (const Items::Item& item : facts.all())
    if (!item.list)
      story.facts.emplace_back(item.name,
                               fmt::format("{}{}{}{}", item.text, item.unit.empty() ? "" : " ", item.unit,
                                           item.note.empty() ? "" : " (" + item.note + ")"));
  story.left_out = left_out();
  return story;
}

std::shared_ptr<const ViewFrame> StoredRun::kept(size_t k) {
  const std::lock_guard lock(guard_);
  for (const auto& [number, frame] : made_)
    if (number == k) return frame;
  auto frame = std::make_shared<const ViewFrame>(this->frame(k));
  made_.emplace_back(k, frame);
  if (made_.size() > kKept) made_.pop_front();
  return frame;
}

Story StoredRun::told() const {
  Story story = tell();
  // The bounds of each, of which the page makes metres; without what else a frame has to be measured for.
  for (size_t k = 0; k < chosen_.size(); ++k)
    story.frames.push_back(form_.bounds(bare_frame(chosen_[k])).json());
  return story;
}

std::string StoredRun::story() {
  Story story = told();
  story.machine = machine_.json({});
  return story.json();
}

std::vector<size_t> StoredRun::steps_of_frames() const {
  std::vector<size_t> steps;
  for (size_t k = 0; machine_.steps() > 0 && k < chosen_.size(); ++k) {
    const size_t step = std::min<size_t>(shots_.step(chosen_[k]), machine_.steps() - 1);
    if (steps.empty() || steps.back() < step) steps.push_back(step);
  }
  return steps;
}

Bytes StoredRun::machine(const std::string& block, size_t k) {
  const auto bytes = [](std::string text) { return std::make_shared<const std::string>(std::move(text)); };
  if (!machine_.is_there()) return nullptr;
  if (block == "nodes" && k == 0) return bytes(machine_.nodes());
  if (block == "held" && k < chosen_.size()) return bytes(held(k));
  if (block == "spans" && k < machine_.steps()) return bytes(machine_.spans(k));
  return nullptr;
}

std::string StoredRun::news(size_t, size_t) {
  return json_object(
      {{"frames", "[]"}, {"lines", "[]"}, {"state", json(std::string("ended"))}, {"whole", "true"}});
}

Bytes StoredRun::block(size_t frame, size_t block, std::optional<size_t> row) {
  if (frame >= chosen_.size() || block >= form_.blocks().size()) return nullptr;
  const std::shared_ptr<const ViewFrame> whole = kept(frame);
  const std::string& bytes = whole->blocks[block];
  if (row) return row_of(bytes, form_.blocks()[block].row(), *row);
  return Bytes(whole, &bytes);
}

}  // namespace cuboct
