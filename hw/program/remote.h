// SPDX-License-Identifier: MIT
// A run in an engine's program, which leaves a trace.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hw/program/frame_files.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/run/record.h"

namespace cuboct {

struct RemoteRun {
  std::string program;             // its path
  std::string scene, arch;         // files; no arch: the defaults
  std::string trace;               // the file that it leaves; others begin with its name while it runs
  std::vector<std::string> own{};  // options that the engine alone has
  int ranks = 1;                   // more: processes over MPI
  bool unpacked = false;           // the trace: packing millions of particles takes longer than many steps
  std::string stage{}, from{};     // model/run/start.h
  std::string scene_path{};        // of which `scene` is a copy; empty: of none
  bool quiet = false;              // the program's words are kept, else its table on stderr is shown
  RunRequest request{};
  // Runs these words in a program that is there, and gives their exit code; empty: in one of its own.
  std::function<int(const std::vector<std::string>&)> elsewhere{};
};

class Remote {
 public:
  // Starts. Throws InputError where nothing can be started.
  explicit Remote(RemoteRun run);
  Remote(Remote&&) = default;

  // Waits. Frames go where the request keeps them, as they come; a program that fails leaves those before.
  // Without a place to keep them they come with the trace. Throws what the program threw, InputError or
  // std::runtime_error; the latter too where it failed otherwise and left no trace.
  Recorded finish();
  // On stdout, where it was quiet.
  std::string said() const { return read_text(file(".said")); }

 private:
  bool over_mpi() const { return run_.ranks > 1; }
  std::string file(const char* ending) const { return run_.trace + ending; }
  void start(std::vector<std::string> arguments);
  void wait();
  bool take_frame();
  std::string errors() const;
  Recorded read() const;

  RemoteRun run_;
  std::optional<FrameReceiver> frames_;
  std::optional<Process> process_;
  std::vector<std::string> words_;  // of a run elsewhere
  std::string trouble_;
};

}  // namespace cuboct
