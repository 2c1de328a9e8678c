// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/multiscale_text.h"
#include "model/base/directory_lock.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/progress.h"
#include "model/base/resources.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct Options {
  std::string study, out;
  int threads = 0;
  Answer answer;
};

// A line on a terminal, rewritten in place.
class Status {
 public:
  ~Status() {
    if (shown_) fmt::print(stderr, "\r\x1b[K");
  }
  void say(size_t set, size_t sets, double part) {
    if (!stderr_is_terminal()) return;
    fmt::print(stderr, "\r\x1b[Kset {} of {}: {:.0f} %", set + 1, sets, 100 * part);
    std::fflush(stderr);
    shown_ = true;
  }

 private:
  bool shown_ = false;
};

std::vector<SetOutcome> run(const ElementStudy& study, const std::shared_ptr<const SampleMaterial>& material,
                            const Options& options, const std::string& out) {
  Status status;
  ElementRunOptions how;
  how.threads = options.threads > 0 ? options.threads : usable_cores();
  how.progress = out + "/progress";
  how.see = [&](size_t set, double part) {
    status.say(set, study.sets, part);
    return !interrupted();
  };
  try {
    return run_elements(study, material, how);
  } catch (const ElementRunStopped&) {
    throw Failed("interrupted; the same command goes on where it was");
  } catch (const ElementError& error) {
    throw Failed(error.what());
  }
}

void multiscale(const Options& options) {
  const ElementStudy study = read_element_study(options.study);
  const std::string out = options.out.empty()
                              ? std::filesystem::path(options.study).stem().string() + ".multiscale"
                              : options.out;
  const std::shared_ptr<const SampleMaterial> material = material_of(study);
  const DirectoryLock lock(out, "cuboct multiscale");
  check_writable(out + "/summary.json");
  catch_interrupts();
  const ElementFindings found{study, *material, run(study, material, options, out)};
  const Items items = items_of(found);
  write_element_tables(found, out);
  write_text(out + "/summary.json", items.json());
  options.answer.close(items);
  try {
    draw_elements(found, out);
  } catch (const InputError& error) {
    fmt::print(stderr, "no pictures: {}\n", error.what());
  }
  options.answer.say("directory {}\n", line_text(out));
}

}  // namespace

void add_multiscale(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("multiscale", "stretch or strike a body whose elements carry their atoms");
  command->add_option("study", options->study, "study file (TOML)")->required()->type_name("STUDY");
  command
      ->add_option("--out", options->out,
                   "directory for results; default: that of the study's name with .multiscale")
      ->type_name("DIR");
  command->add_option("--threads", options->threads, "they change no bit; default: one per core")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  options->answer.add_to(*command);
  command->callback([options, &exit_code] { multiscale(*options), exit_code = 0; });
}

}  // namespace cuboct
