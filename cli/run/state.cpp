// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
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

Frame frame_of(const Trace& trace, const Loaded& loaded, const StateOptions& options) {
  if (!trace.bodies.empty()) {
    const RealFrame& real = trace.bodies[frame_at(trace.bodies, options)];
    return {real.step, static_cast<double>(real.step) * loaded.scene.rule.dt, real.x, real.v,
            loaded.scene.body.type};
  }
  if (trace.frames.empty())
    throw InputError(fmt::format("{} holds no state of particles", options.directory),
                     "a run without --no-states leaves them");
  const State& state = trace.frames[frame_at(trace.frames, options)];
  const Plan& plan = loaded.setup.plan;
  Body body = to_real(state, plan.rule, plan.lattice, plan.origin);
  return {state.step, static_cast<double>(state.step) * plan.rule.dt, std::move(body.x), std::move(body.v),
          std::move(body.type)};
}

void save(const StateOptions& options) {
  const RunRecord record = read_record(options.directory);
  const Trace trace = read_run(options.directory, record);
  const Loaded loaded = scene_of_run(options.directory, record, trace);
  const Frame frame = frame_of(trace, loaded, options);
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

void add_state(Command& app, int&) {
  auto options = std::make_shared<StateOptions>();
  Command command = add_command(app, "state");
  command.option("directory", options->directory, "what 'cuboct run --out' wrote")
      .required()
      .type_name("DIR");
  command
      .option("--out", options->out,
              "the file: extended XYZ, all digits kept, which [particles] of a scene reads")
      .required()
      .type_name("FILE");
  command.option("--step", options->step, "the step of a frame that the run kept; default: the last")
      .check(whole_number)
      .type_name("N");
  options->answer.add_to(command);
  command.callback([options] { save(*options); });
}

}  // namespace cuboct
