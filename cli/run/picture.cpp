// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "hw/program/options.h"
#include "model/base/directory_lock.h"
#include "model/base/input_file.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "model/trace/guarded_trace.h"
#include "model/trace/raster_plot.h"

namespace cuboct {
namespace {

struct PictureOptions {
  std::string directory, out, field = "strain";
  std::vector<uint64_t> steps;
  double limit = 0;
  int width = 1600;
  Answer answer;
};

std::vector<size_t> frames_of(const Rasters& rasters, const std::vector<uint64_t>& steps) {
  std::vector<size_t> frames;
  for (const uint64_t step : steps) {
    size_t k = 0;
    while (k < rasters.frames.size() && rasters.frames[k].step != step) ++k;
    if (k == rasters.frames.size()) {
      std::vector<uint64_t> kept;
      for (const Raster& frame : rasters.frames) kept.push_back(frame.step);
      throw InputError(fmt::format("no frame of step {}", step),
                       fmt::format("kept are {}", fmt::join(kept, ", ")));
    }
    frames.push_back(k);
  }
  return frames;
}

std::string above_zero(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool fine =
      error == std::errc() && end == text.data() + text.size() && std::isfinite(value) && value > 0;
  return fine ? std::string() : fmt::format("'{}' is not a number above 0", text);
}

void draw(const PictureOptions& options) {
  const Field field = field_of(options.field);
  const std::string out = options.out.empty() ? options.directory + "/picture.png" : options.out;
  const std::string path = options.directory + "/rasters.h5";
  if (!is_file(path))
    throw InputError(fmt::format("{} holds no pictures: no file rasters.h5", options.directory),
                     "'cuboct run SCENE --out DIR' makes one");
  std::optional<DirectoryLock> lock;
  if (options.out.empty()) lock.emplace(options.directory, "cuboct picture");
  const Rasters rasters = guarded_rasters(path);
  RasterPicture picture{field, frames_of(rasters, options.steps), options.limit, options.width};
  if (options.steps.empty()) picture.frames = spread_frames(rasters.frames.size());
  check_writable(out);
  const std::string png = plot_rasters(rasters, picture);
  write_text(out, png);
  options.answer.say("{}\n", line_text(out));
  options.answer.close(json_object({{"file", json(out)}}));
}

}  // namespace

void add_picture(Command& app, int& exit_code) {
  auto [command, options] = add_command<PictureOptions>(app, "picture", exit_code, draw);
  command.option("directory", options->directory, "what 'cuboct run --out' wrote", "DIR").required();
  command.option("--out", options->out, "the PNG file; default: DIR/picture.png", "FILE");
  command.option("--field", options->field, "strain, speed, thickness or broken (bonds)")
      .proposed({"strain", "speed", "thickness", "broken"})
      .show_default();
  command
      .option("--steps", options->steps,
              "frames to draw, by their steps; default: first, last and two between", "N,...")
      .delimiter(',')
      .check(whole_number);
  command
      .option("--limit", options->limit,
              "where the colours end: strain (0.01 is 1 %), m/s, m or bonds; default: the 90th "
              "percentile of all frames",
              "V")
      .check(above_zero);
  command.option("--width", options->width, "pixels of the picture", "PX").range(400, 16384).show_default();
  options->answer.add_to(command);
}

}  // namespace cuboct
