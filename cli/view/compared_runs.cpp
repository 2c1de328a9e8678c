// SPDX-License-Identifier: MIT
#include "cli/view/compared_runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "model/base/error.h"
#include "model/base/json.h"

namespace cuboct {
namespace {

std::vector<uint64_t> steps_of(const StoredRun& run) {
  std::vector<uint64_t> steps;
  for (size_t k = 0; k < run.frames(); ++k) steps.push_back(run.step(k));
  return steps;
}

// "0, 5, 10, ..., 20".
std::string some_of(const std::vector<uint64_t>& steps) {
  if (steps.empty()) return "at no step";
  if (steps.size() <= 4) return fmt::format("at steps {}", fmt::join(steps, ", "));
  return fmt::format("at steps {}, {}, {}, ..., {}", steps[0], steps[1], steps[2], steps.back());
}

void keep_common(StoredRun& a, StoredRun& b, size_t every) {
  const std::vector<uint64_t> steps_a = steps_of(a), steps_b = steps_of(b);
  std::vector<uint64_t> common;
  std::ranges::set_intersection(steps_a, steps_b, std::back_inserter(common));
  if (common.empty())
    throw InputError(fmt::format("no step has a frame of both runs: {} has frames {}, {} {}", a.directory(),
                                 some_of(steps_a), b.directory(), some_of(steps_b)),
                     "--frame-every of cuboct run says which steps are kept");
  a.keep(common, every);
  b.keep(common, every);
}

}  // namespace

ComparedRuns::ComparedRuns(const std::string& a, const std::string& b, size_t every, size_t particles)
    : a_(a, 1, particles), b_(b, 1, particles) {
  check_comparable(a_, b_);
  keep_common(a_, b_, every);
  difference_ = difference_of(a_, b_);
}

std::string ComparedRuns::with(const Story& second) const {
  return json_object({{"labels", json(std::vector<std::string>{a_.directory(), b_.directory()})},
                      {"story", second.json()},
                      {"difference", difference_.json()}});
}

std::string ComparedRuns::story() {
  Story story = a_.told();
  story.with = with(b_.told());
  return story.json();
}

std::string verdict(const RunDifference& difference, size_t frames, size_t particles) {
  if (const auto& first = difference.first)
    return fmt::format("step {}, particle {}, {}: {} and {}{}", first->step, first->particle, first->field,
                       first->si_a.empty() ? first->words_a : first->si_a,
                       first->si_b.empty() ? first->words_b : first->si_b,
                       first->unit == "1" ? "" : " " + first->unit);
  return fmt::format("none in {} frame{} of {} particles{}", frames, frames == 1 ? "" : "s", particles,
                     difference.besides.empty() ? "" : "; " + difference.besides);
}

}  // namespace cuboct
