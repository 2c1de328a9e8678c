// SPDX-License-Identifier: MIT
#include "emu/gpu/samples/multiscale.h"

#include <fmt/format.h>

#include <chrono>

#include "emu/gpu/messages.h"
#include "emu/gpu/samples/sample_relaxer.h"
#include "hw/program/command_line.h"
#include "hw/program/error_file.h"
#include "hw/program/options.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"
#include "model/base/resources.h"
#include "model/run/element_run.h"

namespace cuboct::gpu {
namespace {

struct StudyRequest {
  std::string study, progress, before, error;
  int device = 0, threads = 0, point = 0;
};

ElementStudy study_of(const StudyRequest& request) {
  ElementStudy study = read_element_study(request.study);
  if (request.point > 0) {
    const std::vector<ElementEffort> efforts =
        study.compare ? efforts_of(*study.compare) : std::vector<ElementEffort>();
    if (static_cast<size_t>(request.point) > efforts.size())
      throw InputError(
          fmt::format("--point {}: the study compares {} points", request.point, efforts.size()));
    study = read_element_study(request.study, efforts[static_cast<size_t>(request.point - 1)]);
  }
  if (!study.material.tersoff)
    throw InputError(fmt::format("{}: samples on a GPU are of Tersoff's potential alone", request.study),
                     "a study with 'springs' runs without --gpu");
  return study;
}

// Counts the time that batches take.
class Timed final : public SampleRelaxer {
 public:
  Timed(std::unique_ptr<SampleRelaxer> inner, double* seconds)
      : inner_(std::move(inner)), seconds_(seconds) {}
  void relax(std::span<const StrainedSample> due, std::span<SampleAnswer> answers) override {
    const auto begin = std::chrono::steady_clock::now();
    inner_->relax(due, answers);
    *seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  Places places() const override { return inner_->places(); }
  void set_places(Places places) override { inner_->set_places(std::move(places)); }

 private:
  std::unique_ptr<SampleRelaxer> inner_;
  double* seconds_;
};

int run(const StudyRequest& request) {
  const ElementStudy study = study_of(request);
  const Device device = device_at(request.device);
  const std::shared_ptr<const SampleMaterial> material = material_of(study);
  catch_interrupts();
  ElementRunOptions how;
  how.threads = request.threads > 0 ? request.threads : usable_cores();
  double relaxing = 0;
  how.relaxer =
      [&, on = device_relaxer(*study.material.tersoff, {.device = device.ordinal, .threads = how.threads})](
          const SampleMaterial& m, size_t samples) {
        return std::make_unique<Timed>(on(m, samples), &relaxing);
      };
  how.progress = request.progress;
  StatusLine status;
  how.see = [&](size_t set, double part) {
    status.say(request.before + set_status(set, study.sets, part));
    return !interrupted();
  };
  const std::vector<SetOutcome> sets = run_elements(study, material, how);
  SampleWork work;
  double seconds = 0;
  for (const SetOutcome& set : sets) work.add(set.work), seconds += set.seconds;
  fmt::print("# {}: {} sets of {} elements with {} atoms each\n", device.name, sets.size(),
             study.mesh.elements.size(), material->lattice.place.size());
  const auto line = [](const char* name, double value, const char* unit) {
    fmt::print("multiscale.{} {:.6g} {}\n", name, value, unit);
  };
  line("time", seconds, "s");
  line("relaxing", relaxing, "s");  // of this run, where an earlier one did a part
  line("relaxations", static_cast<double>(work.relaxations), "1");
  line("evaluations", static_cast<double>(work.evaluations), "1");
  return 0;
}

// Errors reach the command that started us by a file, where it names one.
int run_and_tell(const StudyRequest& request) {
  try {
    return run(request);
  } catch (const ElementRunStopped&) {
    fmt::print(stderr, "cuboct-gpu: interrupted; the same command goes on where it was\n");
    return 1;
  } catch (const InputError& error) {
    if (request.error.empty()) throw;
    write_error(request.error, error);
    return 2;
  } catch (const std::exception& error) {
    if (request.error.empty()) throw;
    write_error(request.error, InputError(error.what()));
    return 1;
  }
}

}  // namespace

int run_multiscale(int argc, char** argv) {
  StudyRequest request;
  Command app(
      "cuboct-gpu multiscale",
      "Computes a study of elements that carry their atoms, with the samples on a GPU; cuboct multiscale "
      "--gpu starts it");
  app.option("study", request.study, "Study file (TOML)", "STUDY").required();
  app.option("--progress", request.progress,
             "File of results, which a run that was cut goes on from and cuboct multiscale reads", "FILE")
      .required();
  app.option("--point", request.point, "Of the study's [compare]", "N").range(1, 1 << 20);
  app.option("--device", request.device, "CUDA's ordinal").show_default();
  app.option("--threads", request.threads, "Of the host; they change no bit; default: one per core", "N")
      .range(1, 4096);
  app.option("--status", request.before, "Words before the line of progress on a terminal");
  app.option("--error", request.error, "File for what went wrong, in place of standard error", "FILE");
  return run_command_line(app, argc, argv, [&] { return run_and_tell(request); });
}

}  // namespace cuboct::gpu
