// SPDX-License-Identifier: MIT
#include "python/page.h"

#include <filesystem>
#include <variant>

#include "cli/run/outputs.h"
#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/trace/trace_file.h"
#include "python/catch_interrupt.h"

namespace cuboct::python {
namespace {

// The directory of a run that is over, as `cuboct view` reads it.
void leave_run(const Shown& shown, const Scratch& scratch, const std::string& directory) {
  const Loaded loaded = load_plan(shown.sources, false, shown.engine, shown.real);
  const TraceHead head = head_of(loaded, shown.real, false);
  std::filesystem::create_directory(directory);
  const std::string path = directory + "/trace.h5";
  TraceWriter writer(path, temporary_beside(path), false, &head);
  for (const RunState& state : shown.states) std::visit([&](const auto& one) { writer.add(one); }, state);
  writer.finish(shown.trace);
  const Input input = write_sources(shown.sources, scratch);
  write_record(directory, {input.scene, input.arch, shown.engine, "finished", input.stage, input.from});
}

}  // namespace

std::string page_of(const Shown& shown, const std::vector<std::string>& words) {
  const std::string program = beside("cuboct");
  if (program.empty())
    throw InputError("no program cuboct was found, which writes pages",
                     "cuboct.set_program_directory names its directory");
  const Scratch scratch;
  const std::string directory = scratch.path("run"), file = scratch.path("page.html"),
                    errors = scratch.path("errors");
  leave_run(shown, scratch, directory);
  std::vector<std::string> all{"view", directory, "--save", file};
  all.insert(all.end(), words.begin(), words.end());
  const CatchForHost catching;
  const int code = Process(program, all, false, {"/dev/null", errors}).wait();
  if (interrupted()) throw Interrupted();
  if (code == 0) return read_text(file);
  std::string text = read_text(errors);
  if (text.ends_with('\n')) text.pop_back();
  throw error_of(text);
}

}  // namespace cuboct::python
