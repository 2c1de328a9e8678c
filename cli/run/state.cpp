// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/outputs.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "model/trace/frames.h"

namespace cuboct {
namespace {

struct StateOptions {
  std::string directory, out;
  std::optional<uint64_t> step;
  Answer answer;
};

template <typename Frames>
size_t frame_at(const Frames& frames, const StateOptions& options) {
  if (!options.step) return frames.size() - 1;
  std::vector<uint64_t> kept;
  for (const auto& frame : frames) kept.push_back(frame.step);
  const auto found = std::ranges::find(kept, *options.step);
  if (found == kept.end())
    throw InputError(fmt::format("--step: no frame of step {}", *options.step),
                     fmt::format("kept are {}; 'frame_every' of [run] keeps more", fmt::join(kept, ", ")));
  return static_cast<size_t>(found - kept.begin());
}

Frame chosen_frame(const Trace& trace, const Loaded& loaded, const StateOptions& options) {
  if (!trace.bodies.empty()) return frame_of(loaded, trace.bodies[frame_at(trace.bodies, options)]);
  if (trace.frames.empty())
    throw InputError(fmt::format("{} holds no state of particles", options.directory),
                     "a run without --no-states leaves them");
  return frame_of(loaded, trace.frames[frame_at(trace.frames, options)]);
}

void save(const StateOptions& options) {
  const RunRecord record = read_record(options.directory);
  const Trace trace = read_run(options.directory, record);
  const Loaded loaded = scene_of_run(options.directory, record, trace);
  const Frame frame = chosen_frame(trace, loaded, options);
  check_writable(options.out);
  write_whole(options.out, [&](const std::string& temporary) {
    XyzWriter(temporary, frame_style(loaded.scene), {.exact = true}).add(frame);
  });
  options.answer.say("{}: {} particles at step {}\n", line_text(options.out), frame.x.size(), frame.step);
  options.answer.close(json_object({{"file", json(options.out)},
                                    {"particles", std::to_string(frame.x.size())},
                                    {"step", std::to_string(frame.step)}}));
}

}  // namespace

void add_state(Command& app, int& exit_code) {
  auto [command, options] = add_command<StateOptions>(app, "state", exit_code, save);
  command.option("directory", options->directory, "what 'cuboct run --out' wrote", "DIR").required();
  command
      .option("--out", options->out,
              "the file: extended XYZ, all digits kept, which [particles] of a scene reads", "FILE")
      .required();
  command.option("--step", options->step, "the step of a frame that the run kept; default: the last", "N")
      .check(whole_number);
  options->answer.add_to(command);
}

}  // namespace cuboct
