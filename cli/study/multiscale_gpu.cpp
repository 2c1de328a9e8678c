// SPDX-License-Identifier: MIT
#include "cli/study/multiscale_gpu.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/study/study_command.h"
#include "hw/engine/engines.h"
#include "hw/program/error_file.h"
#include "model/base/error_parts.h"
#include "model/base/process.h"

namespace cuboct {
namespace {

const EngineRow& row() { return *std::ranges::find_if(engines(), &EngineRow::devices); }

}  // namespace

void check_gpu(const ElementStudy& study) {
  if (!study.material.tersoff)
    throw InputError(fmt::format("{}: --gpu: samples on a GPU are of Tersoff's potential alone", study.path),
                     "leave --gpu out");
  if (beside(row().program).empty())
    throw InputError(fmt::format("--gpu: there is no program {} beside this one", row().program),
                     row().needs);
}

void run_on_gpu(const GpuElements& run) {
  std::vector<std::string> words{"multiscale", run.study, "--progress",
                                 run.progress, "--error", run.progress + ".error"};
  if (run.point > 0) words.insert(words.end(), {"--point", std::to_string(run.point)});
  if (run.threads > 0) words.insert(words.end(), {"--threads", std::to_string(run.threads)});
  if (!run.before.empty()) words.insert(words.end(), {"--status", run.before});
  const std::string said = run.progress + ".error";
  std::filesystem::remove(said);
  const int code = Process(beside(row().program), words).wait();
  if (interrupted()) throw Failed(kGoesOn);
  if (code == 0) return;
  if (!std::filesystem::exists(said))
    throw Failed(code < 0 ? fmt::format("{} was ended by signal {}", row().program, -code)
                          : fmt::format("{} ended with exit code {}", row().program, code));
  const InputError error = read_error(said);
  std::filesystem::remove(said);
  if (code == 2) throw error;
  throw Failed(bare_message(error));
}

}  // namespace cuboct
