// SPDX-License-Identifier: MIT
#include "synth/tool.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"

namespace cuboct::synth {
namespace {

// Where Debian 12 has none, the hint says so.
const std::map<std::string, std::string> kPackages = {
    {"yosys", "yosys"},           {"nextpnr-ice40", "nextpnr-ice40"},
    {"icepack", "fpga-icestorm"}, {"icetime", "fpga-icestorm"},
    {"sta", "opensta"},
};

// yosys keeps a history of its commands in HOME, and leaves what it gave to abc in TMPDIR where it ends with
// an error.
int run_apart(const std::string& program, const std::vector<std::string>& arguments, const Streams& streams,
              const std::function<bool()>& meanwhile = {}) {
  const Scratch scratch;
  const std::string here = scratch.path(".");
  return Process(program, arguments, false, streams, {"HOME=" + here, "TMPDIR=" + here}).wait({}, meanwhile);
}

}  // namespace

ToolFailed::ToolFailed(const std::string& tool, const std::string& log_name, const std::string& complaint)
    : std::runtime_error(fmt::format("{} failed: {}", tool, complaint)), log(log_name) {}

void need(const std::string& program) {
  if (in_path(program)) return;
  const auto package = kPackages.find(program);
  throw InputError(fmt::format("{} is not in PATH", program),
                   package == kPackages.end() ? "Debian 12 has no package of it"
                                              : fmt::format("apt-get install {}", package->second));
}

Runner::Runner(std::string directory, Hears hears)
    : directory_(std::move(directory)), hears_(std::move(hears)) {}

void Runner::run(const std::string& what, const std::string& name, const std::string& program,
                 const std::vector<std::string>& arguments) const {
  need(program);
  if (interrupted()) throw Interrupted();
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  int heard = 0;  // seconds
  hears_(what, heard);
  const auto each_second = [&] {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - begin).count();
    if (seconds > heard) hears_(what, heard = static_cast<int>(seconds));
    return false;
  };
  const std::string out = path(name + ".log"), err = path(name + ".err");
  const int status = run_apart(program, arguments, {out, err}, each_second);
  // One log: what went to stderr, if anything, after what went to stdout.
  {
    std::ofstream all(out, std::ios::app);
    all << read_text(err);
  }
  std::filesystem::remove(err);
  if (interrupted()) throw Interrupted();
  if (status != 0) {
    std::string complaint =
        status < 0 ? fmt::format("ended by signal {}", -status) : complaint_of(read_text(out));
    // icetime's data are a package of their own, which the tool's only recommends.
    if (complaint.find("chipdb") != std::string::npos) complaint += "; apt-get install fpga-icestorm-chipdb";
    throw ToolFailed(program, name + ".log", complaint);
  }
}

void Runner::write(const std::string& name, const std::string& text) const { write_text(path(name), text); }

std::string first_line(const std::string& program, const std::string& argument) {
  const Scratch scratch;
  const std::string out = scratch.path("out"), err = scratch.path("err");
  if (!in_path(program)) return "";
  run_apart(program, {argument}, {out, err});
  for (const std::string& file : {out, err}) {
    std::istringstream text(read_text(file));
    std::string line;
    if (std::getline(text, line) && !line.empty()) return line;
  }
  return "";
}

std::string complaint_of(const std::string& log) {
  std::string last, complaint;
  std::istringstream in(log);
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) continue;
    last = line;
    if (line.find("ERROR") != std::string::npos || line.find("Error:") != std::string::npos) complaint = line;
  }
  return complaint.empty() ? last : complaint;
}

}  // namespace cuboct::synth
