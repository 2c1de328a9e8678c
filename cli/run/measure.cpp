// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>

#include "cli/answer.h"
#include "cli/programs.h"
#include "cli/run/measure_run.h"
#include "cli/run/measured_particles.h"
#include "cli/run/outputs.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct MeasureOptions {
  std::string directory, out, particles, cutoff, volume;
  MeasureAsked asked;
  int threads = 0;
  uint64_t bins = 0;
  bool bins_given = false, anyway = false;
  Answer answer;
};

bool same_file(const std::string& a, const std::string& b) {
  const auto whole = [](const std::string& path) { return std::filesystem::weakly_canonical(path); };
  return whole(std::filesystem::absolute(a)) == whole(std::filesystem::absolute(b));
}

void measure(const MeasureOptions& options) {
  check_workers("--threads", options.threads, options.anyway);
  MeasureAsked asked = options.asked;
  const RunRecord record = read_record(options.directory);
  const Trace trace = read_run(options.directory, record);
  const Loaded loaded = scene_of_run(options.directory, record, trace);
  const bool reduced = loaded.scene.boltzmann == 1;
  asked.choice.threads = options.threads;
  if (options.bins_given) asked.choice.bins = options.bins;
  if (!options.cutoff.empty()) asked.choice.cutoff = size_of("--cutoff", options.cutoff, false, reduced);
  if (!options.volume.empty()) asked.choice.volume = size_of("--volume", options.volume, true, reduced);
  if (!options.out.empty()) check_writable(options.out);
  if (!options.out.empty() && !options.particles.empty() && same_file(options.out, options.particles))
    throw InputError(fmt::format("--out and --particles name one file: '{}'", options.particles),
                     "the table goes to one, each particle's numbers to another");
  std::optional<ParticlesFile> particles;
  SeeParticles see;
  if (!options.particles.empty()) {
    particles.emplace(options.particles, loaded);
    see = [&](const KeptFrame& kept, const Snapshot& now, const MeasuredParticles& of) {
      particles->add(kept, now, of);
    };
  }
  const Measured measured = measure_trace(loaded, trace, asked, see);
  if (particles) particles->finish();
  const std::string csv = csv_of(measured, !reduced);
  std::string notes;
  for (const auto& [name, text] : measured.notes) notes += fmt::format("{:<14}{}\n", name, line_text(text));
  if (!options.out.empty()) {
    write_text(options.out, csv);
    options.answer.say("{}", notes);
  } else {
    if (!options.answer.json) fmt::print(stderr, "{}", notes);
    options.answer.say("{}", csv);
  }
  options.answer.close(json_of(asked.name, measured, !reduced));
}

}  // namespace

void add_measure(Command& app, int& exit_code) {
  auto [command, options] = add_command<MeasureOptions>(app, "measure", exit_code, measure);
  MeasureAsked& asked = options->asked;
  command.option("directory", options->directory, "what 'cuboct run --out' wrote", "DIR").required();
  command
      .option("measure", asked.name,
              "rdf (radial distribution), msd (mean squared displacement), coordination, cna (common "
              "neighbours: fcc, hcp, bcc, icosahedral) or stress (of the virial)",
              "WHAT")
      .required()
      .proposed(measure_names());
  command.option("--frames", asked.frames,
                 "all, half (the second), last, steps as 0,500, or from one step to another as 100:900; "
                 "default: half for rdf, else all",
                 "FRAMES");
  command.option(
      "--cutoff", options->cutoff,
      "a length. rdf: where g(r) ends, by default 4.1 pitches; coordination: who is a neighbour, by "
      "default between first and second shell; cna: by default none, it adapts",
      "LENGTH");
  command.option("--bins", options->bins, "of rdf; default: 200", "N")
      .range(uint64_t{1}, kMostBins)
      .given(options->bins_given);
  command
      .option(
          "--types", asked.choice.types,
          "materials. rdf: those of B about those of A; other measures count their particles; default: all",
          "A,B")
      .delimiter(',');
  command.option(
      "--volume", options->volume,
      "what densities and stresses are over; default: the periodic box, of other bodies that of the "
      "particles as packed",
      "VOLUME");
  command.flag("--com", asked.choice.com, "msd without the motion of the centre of mass");
  command.flag("--virial", asked.choice.virial, "stress without its kinetic part");
  command.option(
      "--particles", options->particles,
      "what each particle has, by frames: .csv, .xyz, .xyz.gz, .dump.gz (LAMMPS) or .pvd (ParaView)", "FILE");
  command.option("--out", options->out, "the CSV file; default: to the terminal", "FILE");
  command.option("--threads", options->threads, "default: one per core", "N").range(1, 4096);
  add_anyway_to(command, options->anyway);
  options->answer.add_to(command);
}

}  // namespace cuboct
