// SPDX-License-Identifier: MIT
#include "cli/study/learn.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "cli/answer.h"
#include "cli/programs.h"
#include "cli/study/learn_cracks.h"
#include "cli/study/study_command.h"
#include "model/base/output.h"
#include "model/base/resources.h"
#include "model/base/text.h"
#include "model/trace/plot.h"
#include "study/learn/learn.h"
#include "study/learn/spread.h"

namespace cuboct {
namespace {

using learn::KernelFit;
using learn::Learned;

struct LearnOptions {
  std::string study, out;
  int jobs = 0;
  bool anyway = false;
  Answer answer;
};

// Of the fits with samples drawn anew.
std::string spread(const Learned& found, double (*of)(const KernelFit&), const char* format) {
  const learn::Spread drawn = learn::spread_of(found.drawn, of);
  return fmt::format(fmt::runtime(format), drawn.mean, drawn.deviation, found.drawn.size());
}

Items items_of(const learn::LearnStudy& study, const Learned& found) {
  const learn::Tried& best = found.tried[found.best];
  const learn::Kernel& kernel = best.fit.kernel;
  const auto waves = learn::WaveOperator(found.grid, best.horizon).long_waves(kernel);
  const char* tera = "samples drawn anew: {:.4f} +- {:.4f} TPa, {} times";
  const char* share = "samples drawn anew: {:.4f} +- {:.4f}, {} times";
  Items items;
  items.add("study", study.title);
  items.add("atoms", static_cast<uint64_t>(found.atoms));
  items.add("samples", static_cast<uint64_t>(found.training.size()), "",
            fmt::format("and {} to validate; a bond is strained by {:.2g} % at most", found.validation.size(),
                        100 * found.strain));
  items.add("horizon", best.horizon, "spacings", fmt::format("of {:.3g} m", found.grid.step()));
  items.add("degree", best.degree);
  items.add("lambda", kernel.lambda / 1e12, "TPa",
            spread(
                found, [](const KernelFit& f) { return f.kernel.lambda / 1e12; }, tera));
  items.add("mu", kernel.mu / 1e12, "TPa",
            spread(
                found, [](const KernelFit& f) { return f.kernel.mu / 1e12; }, tera));
  items.add("alpha", kernel.alpha);
  items.add("D", fmt::format("{:.6g}", fmt::join(kernel.D, " ")));
  items.add("C11 of long waves", waves[0] / 1e12, "TPa");
  items.add("C66 of long waves", waves[1] / 1e12, "TPa",
            fmt::format("on the diagonal {:.4g} TPa", waves[2] / 1e12));
  items.add("training residual", best.fit.training, "",
            spread(
                found, [](const KernelFit& f) { return f.training; }, share));
  items.add("validation residual", best.fit.validation, "",
            spread(
                found, [](const KernelFit& f) { return f.validation; }, share));
  items.add("least constraint", best.fit.constraint, "", "at least 0 where it holds");
  return items;
}

void write_tables(const Learned& found, const std::string& directory) {
  std::string fits =
      "horizon\tdegree\ttraining\tvalidation\tconstraint\tlambda_TPa\tmu_TPa\talpha\tevaluations\n";
  for (const learn::Tried& t : found.tried)
    fits += fmt::format("{:g}\t{}\t{:.6g}\t{:.6g}\t{:.3g}\t{:.6g}\t{:.6g}\t{:.6g}\t{}\n", t.horizon, t.degree,
                        t.fit.training, t.fit.validation, t.fit.constraint, t.fit.kernel.lambda / 1e12,
                        t.fit.kernel.mu / 1e12, t.fit.kernel.alpha, t.fit.evaluations);
  write_text(directory + "/fits.tsv", fits);
  std::string curve = "evaluations\ttraining\tvalidation\n";
  for (const learn::CurvePoint& p : found.tried[found.best].fit.curve)
    curve += fmt::format("{}\t{:.6g}\t{:.6g}\n", p.evaluations, p.training, p.validation);
  write_text(directory + "/curve.tsv", curve);
}

void draw(const Learned& found, const std::string& directory) {
  std::string rows;
  for (const learn::CurvePoint& p : found.tried[found.best].fit.curve)
    rows += fmt::format("{} {:.6g} {:.6g}\n", p.evaluations, p.training, p.validation);
  draw_plot(directory + "/curve.svg", plot_block("curve", rows),
            "set grid lc '#dddddd' lt 1\nset border 3\nset tics nomirror\nset logscale y\n"
            "set format y '10^{%T}'\nset xlabel 'evaluations'\nset ylabel 'residual'\n"
            "plot $curve using 1:2 with lines lw 2 lc rgb '#1f5fa8' title 'training', "
            "$curve using 1:3 with lines lw 2 lc rgb '#b03020' title 'validation'\n",
            640, 400);
}

void run(const LearnOptions& options) {
  check_workers("--jobs", options.jobs, options.anyway);
  const learn::LearnStudy study = learn::read_learn_study(options.study);
  const std::string out = out_of(options.out, options.study, ".learn");
  learn::check_loads(study);
  kept_in(out, "cuboct learn", [&] {
    check_writable(out + "/summary.json");
    const int jobs = options.jobs > 0 ? options.jobs : usable_cores();
    if (study.cracks) learn::check_cracks(study);
    const Learned found = learn::learn(study, out, jobs);
    std::optional<learn::Cracks> cracks;
    if (study.cracks) cracks = learn::learn_cracks(study, found, out, jobs);
    Items items = items_of(study, found);
    write_tables(found, out);
    if (cracks) add_cracks(items, study, *cracks), write_crack_tables(study, *cracks, out);
    write_text(out + "/summary.json", items.json());
    options.answer.close(items);
    drawn("picture", [&] {
      draw(found, out);
      if (cracks) draw_cracks(study, *cracks, out);
    });
  });
  options.answer.say("directory {}\n", line_text(out));
}

}  // namespace

void add_learn(Command& app, int& exit_code) {
  auto [command, options] = add_command<LearnOptions>(app, "learn", exit_code, run);
  add_study_to(command, options->study);
  add_out_to(command, options->out, "study", ".learn");
  add_jobs_to(command, options->jobs, options->anyway, "samples at once");
  options->answer.add_to(command);
}

}  // namespace cuboct
