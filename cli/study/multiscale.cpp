// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <map>
#include <memory>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/machine/technologies.h"
#include "cli/programs.h"
#include "cli/study/multiscale_compare.h"
#include "cli/study/multiscale_gpu.h"
#include "cli/study/multiscale_node.h"
#include "cli/study/multiscale_text.h"
#include "cli/study/study_command.h"
#include "hw/program/bounds.h"
#include "model/base/output.h"
#include "model/base/progress.h"
#include "model/base/resources.h"
#include "model/base/spelling.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct MultiscaleOptions {
  std::string study, out;
  bool gpu = false, anyway = false;
  int threads = 0, fraction = SampleNodeOptions().fraction;
  std::vector<std::string> technologies;  // of a node; empty: none is counted
  std::string clock = "1 GHz";
  Answer answer;
};

// `point`: of [compare], from 1; 0: the study itself.
std::vector<SetOutcome> run(const ElementStudy& study, const std::shared_ptr<const SampleMaterial>& material,
                            const MultiscaleOptions& options, const std::string& progress, size_t point = 0,
                            const std::string& before = {}) {
  if (options.gpu) run_on_gpu({options.study, progress, before, point, options.threads});
  ElementRunOptions how;
  StatusLine status;
  how.threads = options.threads > 0 ? options.threads : usable_cores();
  how.progress = progress;
  how.see = [&](size_t set, double part) {
    status.say(before + set_status(set, study.sets, part));
    return !interrupted();
  };
  try {
    return run_elements(study, material, how);
  } catch (const ElementRunStopped&) {
    throw Failed(kGoesOn);
  } catch (const ElementError& error) {
    throw Failed(error.what());
  }
}

void run_study(const ElementStudy& study, const std::shared_ptr<const SampleMaterial>& material,
               const MultiscaleOptions& options, const std::string& out) {
  std::optional<NodeFindings> node;
  if (!options.technologies.empty())
    node = node_of(study, *material, options.fraction, options.clock, options.technologies);
  const ElementFindings found{study, *material, run(study, material, options, out + "/progress")};
  Items items = items_of(found);
  if (node) add_node(items, *node), write_node(*node, out);
  write_element_tables(found, out);
  write_text(out + "/summary.json", items.json());
  options.answer.close(items);
  drawn("pictures", [&] { draw_elements(found, out); });
}

// Each point of the grid with the study's own file, and a file of progress of its own.
void run_comparison(const ElementStudy& study, const MultiscaleOptions& options, const std::string& out) {
  std::map<std::pair<int, double>, std::shared_ptr<const SampleMaterial>> materials;
  const auto point_of = [&](const ElementEffort& effort, size_t point, const std::string& before) {
    const ElementStudy one = read_element_study(options.study, effort);
    auto& material = materials[{effort.cells, effort.force}];
    if (material == nullptr) material = material_of(one);
    return compared_point(
        effort, one, *material,
        run(one, material, options, fmt::format("{}/progress.{}", out, point), point, before));
  };
  const std::vector<ElementEffort> efforts = efforts_of(*study.compare);
  Comparison compared{study.title, {}, {}};
  for (size_t k = 0; k < efforts.size(); ++k)
    compared.points.push_back(
        point_of(efforts[k], k + 1, fmt::format("point {} of {}, ", k + 1, efforts.size())));
  const auto at = std::ranges::find(efforts, finest(*study.compare));
  compared.finest = compared.points[static_cast<size_t>(at - efforts.begin())];
  const Items items = items_of(compared);
  write_comparison(compared, out);
  write_text(out + "/summary.json", items.json());
  options.answer.close(items);
  drawn("pictures", [&] { draw_comparison(compared, out); });
}

void multiscale(const MultiscaleOptions& options) {
  check_workers("--threads", options.threads, options.anyway);
  const ElementStudy study = read_element_study(options.study);
  const std::string out = out_of(options.out, options.study, ".multiscale");
  if (study.compare && !options.technologies.empty())
    throw InputError("--technology: a node is counted for one study, not for a comparison");
  if (options.gpu) check_gpu(study);
  const std::shared_ptr<const SampleMaterial> material = material_of(study);
  kept_in(out, "cuboct multiscale", [&] {
    check_writable(out + "/summary.json");
    if (study.compare)
      run_comparison(study, options, out);
    else
      run_study(study, material, options, out);
  });
  options.answer.say("directory {}\n", line_text(out));
}

}  // namespace

void add_multiscale(Command& app, int& exit_code) {
  auto [command, options] = add_command<MultiscaleOptions>(app, "multiscale", exit_code, multiscale);
  add_study_to(command, options->study);
  add_out_to(command, options->out, "study", ".multiscale");
  command.option("--threads", options->threads, "they change no bit; default: one per core", "N")
      .range(1, 4096);
  add_anyway_to(command, options->anyway);
  command.flag("--gpu", options->gpu,
               "relax samples on the first GPU: pays from some 400,000 relaxations on");
  command
      .option("--technology", options->technologies,
              "also count a node for each element, in joules of these: " + list_of(technology_names()) +
                  ", or files",
              "NAME")
      .delimiter(',')
      .proposed(technology_names());
  command.option("--clock", options->clock, "of the node", "F").show_default();
  command.option("--fraction", options->fraction, "bits behind the point of the node's numbers", "BITS")
      .range(10, 40)
      .show_default();
  options->answer.add_to(command);
}

}  // namespace cuboct
