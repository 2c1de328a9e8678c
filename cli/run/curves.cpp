// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/curves.h"
#include "cli/run/outputs.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/spelling.h"
#include "model/trace/curves_csv.h"

namespace cuboct {
namespace {

struct CurvesOptions {
  std::string directory, out;
  std::vector<std::string> names;
};

// Of "grip" all curves of that probe, of "grip.force_x" one.
std::vector<Curve> chosen(const std::vector<Curve>& all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  std::vector<Curve> curves;
  std::set<std::string> known;
  for (const Curve& curve : all)
    known.insert(curve.name), known.insert(curve.name.substr(0, curve.name.find('.')));
  for (const std::string& name : names) {
    bool found = false;
    for (const Curve& curve : all) {
      if (curve.name != name && !curve.name.starts_with(name + ".")) continue;
      found = true;
      if (std::ranges::find(curves, curve.name, &Curve::name) == curves.end()) curves.push_back(curve);
    }
    if (found) continue;
    const std::vector<std::string> there(known.begin(), known.end());
    const std::string near = did_you_mean(name, there);
    throw InputError(fmt::format("--probe: no curve '{}'", name), near.empty() ? list_of(there) : near);
  }
  return curves;
}

void write_curves(const CurvesOptions& options) {
  const RunRecord record = read_record(options.directory);
  const Trace trace = read_run(options.directory, record);
  const std::vector<Curve> curves = chosen(trace.curves, options.names);
  const std::string csv = csv_of(scene_of_run(options.directory, record, trace).scene, curves);
  if (options.out.empty())
    fmt::print("{}", csv);
  else
    check_writable(options.out), write_text(options.out, csv);
}

}  // namespace

std::string csv_of(const Scene& scene, const std::vector<Curve>& curves) {
  const bool reduced = scene.boltzmann == 1;
  return curves_csv(curves, scene.loading ? std::nullopt : std::optional(scene.rule.dt), !reduced);
}

void add_curves(Command& app, int& exit_code) {
  auto [command, options] = add_command<CurvesOptions>(app, "curves", exit_code, write_curves);
  command.option("directory", options->directory, "what 'cuboct run --out' wrote", "DIR").required();
  command
      .option("--probe", options->names,
              "one or several, with commas: probes, or their curves; default: all curves", "NAME")
      .delimiter(',');
  command.option("--out", options->out, "the CSV file; default: to the terminal", "FILE");
}

}  // namespace cuboct
