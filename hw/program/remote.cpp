// SPDX-License-Identifier: MIT
#include "hw/program/remote.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "hw/program/error_file.h"
#include "hw/program/program.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/trace/trace_file.h"

namespace cuboct {

namespace fs = std::filesystem;

Remote::Remote(RemoteRun run) : run_(std::move(run)) {
  std::vector<std::string> arguments =
      program_arguments(run_.scene, run_.arch, run_.request, run_.trace, file(".steps"));
  arguments.insert(arguments.end(), {"--error", file(".error")});
  arguments.insert(arguments.end(), run_.own.begin(), run_.own.end());
  for (const auto& [option, value] :
       {std::pair{"--stage", run_.stage}, {"--from", run_.from}, {"--scene-path", run_.scene_path}})
    if (!value.empty()) arguments.insert(arguments.end(), {option, value});
  if (!run_.request.checkpoint.path.empty()) arguments.emplace_back("--keep-checkpoint");
  if (run_.unpacked) arguments.emplace_back("--unpacked");
  if (run_.request.keep) {
    frames_.emplace(file(".frame"));
    arguments.insert(arguments.end(), {"--frame-files", file(".frame")});
  }
  fs::remove(run_.trace);  // what is found there afterwards is this run's
  start(std::move(arguments));
}

void Remote::start(std::vector<std::string> arguments) {
  const Streams streams = run_.quiet ? Streams{file(".said"), file(".errors")} : Streams{};
  if (run_.elsewhere) {
    words_ = std::move(arguments);
    return;
  }
  if (!over_mpi()) {
    process_.emplace(run_.program, arguments, false, streams);
    return;
  }
  if (!in_path("mpirun"))
    throw InputError(fmt::format("--ranks {}: no program mpirun", run_.ranks), "install openmpi-bin");
  std::vector<std::string> words{"--quiet", "--oversubscribe",          "--bind-to", "none",
                                 "-n",      std::to_string(run_.ranks), run_.program};
  // Open MPI warns root, who in a container is everyone.
  if (geteuid() == 0) words.insert(words.begin(), "--allow-run-as-root");
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"--begun", file(".begun")});
  process_.emplace("mpirun", words, true, streams);
}

// Without the names of our files, which are of no use to others.
std::string Remote::errors() const {
  const std::string directory = fs::path(run_.trace).parent_path().string() + "/";
  std::string text = read_text(file(".errors"));
  for (size_t at = text.find(directory); at != std::string::npos; at = text.find(directory))
    text.erase(at, directory.size());
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

bool Remote::take_frame() { return frames_ && frames_->receive(run_.request.keep, run_.request.read); }

void Remote::wait() {
  const auto begun = [this] { return !over_mpi() || fs::exists(file(".begun")); };
  const int code =
      run_.elsewhere ? run_.elsewhere(words_) : process_->wait(begun, [this] { return take_frame(); });
  while (take_frame()) {
  }
  const std::string name = over_mpi() ? "mpirun" : fs::path(run_.program).filename().string();
  const std::string said = run_.quiet && process_ ? errors() : "";
  std::optional<InputError> error;
  if (fs::exists(file(".error"))) error = read_error(file(".error"));
  for (const char* ending : {".steps", ".begun", ".errors", ".error"}) fs::remove(file(ending));
  const bool left = fs::exists(run_.trace);
  // Of a program that was ended while it wrote one.
  const std::string& checkpoint = run_.request.checkpoint.path;
  if (code != 0 && !checkpoint.empty()) fs::remove(checkpoint + ".tmp");
  // A program that could not write all of it leaves what it has.
  if (code == 2 && left) {
    trouble_ = error ? parts_of(*error).message : name + " could not write all of it";
    return;
  }
  if (error && code == 2) throw *error;
  const std::string goes_on =
      !checkpoint.empty() && fs::exists(checkpoint) ? "; --resume goes on from the last checkpoint" : "";
  if (error && code == 1 && !left) throw std::runtime_error(error->what() + goes_on);
  // Exit code 1 with a trace: the run had to stop or found something wrong, and the trace says what.
  if (code == 0 || (code > 0 && left)) return;
  if (interrupted() && (code < 0 || over_mpi()))
    throw std::runtime_error(fmt::format("interrupted before {} began", over_mpi() ? "the ranks" : name));
  if (!said.empty()) throw std::runtime_error(said);
  // A shell's way, and mpirun's, to tell of a signal.
  const int signal = code < 0 ? -code : over_mpi() && code > 128 ? code - 128 : 0;
  if (signal > 0)
    throw std::runtime_error(fmt::format("{} was ended by signal {} ({}){}", code < 0 ? name : "a rank",
                                         signal, strsignal(signal), goes_on));
  const std::string why = over_mpi() ? ": MPI failed, or a rank gave up" : "";
  throw std::runtime_error(fmt::format("{} ended with exit code {}{}{}", name, code, why, goes_on));
}

Recorded Remote::read() const {
  const RunRequest& request = run_.request;
  const TraceReader reader(run_.trace);
  Recorded run;
  run.trace = reader.rest();
  take_totals(run);
  run.interrupted = run.trace.steps() < request.steps && !run.trace.stop && !run.trace.reached;
  run.trouble = trouble_;
  run.left_checkpoint = run.interrupted && fs::exists(request.checkpoint.path);
  reader.frames([&](State state) { give(request, std::move(state), run.trace); });
  reader.bodies([&](RealFrame frame) { give(request, std::move(frame), run.trace); });
  return run;
}

Recorded Remote::finish() {
  wait();
  return read();
}

}  // namespace cuboct
