// SPDX-License-Identifier: MIT
#include "cli/study/bond_fit.h"

#include <filesystem>

#include "cli/study/bond_fit_text.h"
#include "cli/study/study_command.h"
#include "model/base/clock.h"
#include "model/base/output.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

void draw(const BondFindings& found, const std::string& out) {
  write_convergence(found, out);
  drawn("picture", [&] { draw_convergence(found, out); });
}

void run(const bond_fit::BondStudy& study, const std::string& out, int jobs, const Answer& answer) {
  const Clock::time_point begin = Clock::now();
  const bond_fit::BondFitOptions options{.jobs = jobs};
  const bond_fit::BondFit fit = bond_fit::run_bond_fit(study, out, options);
  std::vector<bond_fit::Compared> compared;
  if (study.compare) compared = bond_fit::compare_methods(study, options);
  const BondFindings found{study, fit, compared, seconds_since(begin)};
  const Items items = items_of(found);
  write_bond_tables(found, out);
  write_text(out + "/summary.json", items.json());
  if (study.compare) draw(found, out);
  answer.close(items);
  if (!fit.best) {
    std::filesystem::remove(out + "/fitted.tersoff");  // of an earlier run with other starts
    throw Failed(fmt::format("none of the {} sets that were tried is stable", fit.tried.size()),
                 "trials.tsv says how each failed; try more sets (fit.tried), or more starts");
  }
  write_text(out + "/fitted.tersoff", potential_file(study, fit));
}

}  // namespace

int fit_bonds(const std::string& path, const std::string& directory, int jobs, const Answer& answer) {
  const bond_fit::BondStudy study = bond_fit::read_bond_study(path);
  const std::string out = out_of(directory, path, ".fit");
  kept_in(out, "cuboct fit", [&] {
    check_writable(out + "/summary.json");
    run(study, out, jobs, answer);
  });
  answer.say("directory {}\n", line_text(out));
  return 0;
}

}  // namespace cuboct
