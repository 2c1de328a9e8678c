// SPDX-License-Identifier: MIT
#include "study/search/pitch_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

#include "model/analysis/tension.h"
#include "model/base/clock.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/json.h"
#include "model/rules/rounds_rule.h"
#include "model/trace/trace_head.h"
#include "study/sweep/kept_lines.h"
#include "study/sweep/probe_run.h"

namespace cuboct::study {
namespace {

constexpr size_t kLeastRuns = 3;  // of a line
constexpr double kFiner = 1 / std::numbers::sqrt2;

void check_law(const ConfigTable& law) {
  if (const auto stiffness = law.find("stiffness"))
    stiffness->fail("'stiffness' is that of a bond of one pitch", "give 'youngs_modulus' and 'direction'");
  const ConfigValue kind = law.at("kind");
  if (kind.string() == "rule")
    kind.fail("another pitch may make another matter of a law that is text",
              "[rule] in the place of [law]: its reach and stiffness are compared at two pitches");
  if (const std::string name = kind.string(); name == "spline" || name == "lj")
    kind.fail(fmt::format("a law '{}' has lengths of its own: another pitch makes another matter", name),
              "elastic, brittle, ductile or viscous, with 'youngs_modulus'");
}

void check_mass(const ConfigTable& table) {
  if (const auto mass = table.find("mass"))
    mass->fail("'mass' is that of a particle of one pitch", "give 'density'");
}

uint64_t hash_of(const PitchQuestion& q) {
  // The packing too: files that the scene names may change.
  const std::string text =
      fmt::format("{:x}\n{}\n{}\n{} {} {} {} {} {} {}", packing_hash(resolve(q.base, {}).scene),
                  q.base.scene_text, q.base.arch_text, q.engine, static_cast<int>(q.figure.kind),
                  q.figure.curve, q.figure.against, q.figure.from, q.figure.to, q.figure.fraction);
  Hash hash;
  for (const char c : text) hash.add(c);
  return hash.value();
}

std::string line_of(const PitchRun& run) {
  return json_object({{"pitch", json(run.pitch)},
                      {"shift", std::to_string(run.shift)},
                      {"particles", std::to_string(run.particles)},
                      {"value", json(run.value)},
                      {"unit", json(run.unit)},
                      {"particle_steps", std::to_string(run.particle_steps)},
                      {"seconds", json(run.seconds)}});
}

// A modulus for which nobody names a window comes from where the curve is straight, as a run's summary has
// it.
double figure_of(const Figure& figure, const Scene& scene, const std::vector<Curve>& curves) {
  const auto probe = std::ranges::find_if(scene.probes, [&](const Probe& one) {
    return figure.curve == one.name + ".stress" && figure.against == one.name + ".strain";
  });
  const bool whole = figure.kind == Figure::Kind::modulus && figure.from == 0 && figure.to == 0;
  const auto tension =
      whole && probe != scene.probes.end() ? tension_of(curves, probe->name) : std::optional<Tension>();
  if (!tension) return value_of(figure, curves, scene.rule.dt);
  const CurveFigure modulus = tension_figures(tension_test(*tension, scene, *probe)).modulus;
  if (!modulus.value) throw std::runtime_error(fmt::format("{}: {}", figure.name, modulus.why));
  return *modulus.value;
}

PitchRun run_at(const PitchQuestion& q, const Case& c, int shift) {
  const Clock::time_point begin = Clock::now();
  const Trace trace = probe_run(c.scene, c.arch, q.engine, q.threads);
  const std::string at = fmt::format("at a pitch of {:.6g} m", c.scene.pitch);
  if (trace.stop) throw std::runtime_error(fmt::format("{} the run stops: {}", at, trace.stop->text));
  PitchRun run;
  run.pitch = c.scene.pitch;
  run.shift = shift;
  run.particles = c.scene.body.size();
  run.unit = q.figure.unit(trace.curves);
  run.particle_steps = particle_steps(c.scene, trace);
  try {
    run.value = figure_of(q.figure, c.scene, trace.curves);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", at, error.what()));
  }
  run.seconds = seconds_since(begin);
  return run;
}

// The digits that a person would write, so that what is run can be written down.
std::string written(double pitch) { return fmt::format("{:.4g}", pitch); }

// The scene with finer packings, shifted along the axes that may be.
class Packings {
 public:
  explicit Packings(const Base& base) : reduced_(is_reduced(base)) {
    const Scene scene = resolve(base, {}).scene;
    pitch_ = scene.pitch;
    orientation_ = scene.orientation;
    const ConfigTable root = parse_config(base.scene_text, base.scene_path);
    offset_ = root.at("packing").table().vector_or("offset", quantity::length, Vec3::Zero());
    const std::array<bool, 3> live = live_axes(scene);
    for (int a = 0; a < 3; ++a)
      free_[a] = live[static_cast<size_t>(a)] && scene.periodic.extent[a] == 0 ? 1 : 0;
    for (const ConfigTable& plane : root.tables("symmetry"))
      free_ =
          free_.cwiseProduct(plane.at("normal").direction().map([](double n) { return n == 0 ? 1.0 : 0.0; }));
  }

  double first() const { return pitch_; }
  int shifts() const { return free_.isZero() ? 1 : kShifts; }
  Settings at(double pitch, int shift) const {
    const Vec3 by = std::numbers::sqrt2 * pitch * orientation_ * shift_of(shift);
    const Vec3 offset = offset_ + by.cwiseProduct(free_);
    Settings settings;
    if (pitch != pitch_) settings.scene.push_back({"packing.pitch", quantity(written(pitch))});
    settings.scene.push_back(
        {"packing.offset", quantity(fmt::format("[{}, {}, {}]", offset[0], offset[1], offset[2]))});
    return settings;
  }

 private:
  std::string quantity(const std::string& text) const {
    return reduced_ ? text : fmt::format("\"{} m\"", text);
  }

  bool reduced_;
  double pitch_ = 0;
  Mat3 orientation_;
  Vec3 offset_, free_ = Vec3::Zero();
};

std::optional<double> answer_of(const PitchQuestion& q, const std::vector<PitchRun>& runs,
                                const PitchLine& line) {
  if (line.error_at(runs.back().pitch) > q.error) return std::nullopt;
  const auto pitch = line.pitch_for(q.error);
  return std::clamp(pitch.value_or(runs.back().pitch), runs.back().pitch, runs.front().pitch);
}

// Student's distribution: what 90 % of deviates stay within, by degrees of freedom from 1 on (Abramowitz and
// Stegun, Handbook of Mathematical Functions, table 26.10).
double within_90(size_t freedom) {
  constexpr double kQuantiles[] = {6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860, 1.833, 1.812};
  return kQuantiles[std::min(freedom, std::size(kQuantiles)) - 1];
}

// Of matter that stays the same the reach grows with the pitch, and so does the stiffness of a particle.
void check_rule(const ConfigValue& rule, const Base& base) {
  const Packings packings(base);
  const auto per_pitch = [&](double pitch) {
    const Scene scene = resolve(base, packings.at(pitch, 0)).scene;
    const RoundsRule* rounds = scene.rule.rounds.get();  // none: the text is a pair law
    const double stiffness = rounds != nullptr ? rounds->stiffness() : -scene.rule.law_at(0).slope(pitch);
    return std::pair{scene.rule.cutoff() / pitch, stiffness / pitch};
  };
  const double pitch = packings.first(), finer = std::stod(written(kFiner * pitch));
  const auto [reach, stiffness] = per_pitch(pitch);
  const auto [fine_reach, fine_stiffness] = per_pitch(finer);
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-9 * std::abs(a); };
  if (differ(reach, fine_reach))
    rule.fail("the rule's reach does not grow with the pitch: another pitch makes another matter",
              "reach = \"1.2 * pitch\"");
  if (differ(stiffness, fine_stiffness))
    rule.fail("the rule's stiffness does not grow with the pitch: another pitch makes another matter",
              "formulas with 'pitch' or 'volume'");
}

}  // namespace

void check_refinable(const Base& base) {
  const ConfigTable root = parse_config(base.scene_text, base.scene_path);
  const auto packing = root.table_at("packing");
  if (!packing) root.fail("the scene has no [packing], so no pitch");
  if (const auto box = root.table_at("box"))
    if (const auto periodic = box->find("periodic"); periodic && !packing->has("grains"))
      periodic->fail("the packing repeats in this box at some pitches only", "a body with faces, or grains");
  if (const auto damping = root.table_at("damping"))
    if (const auto coefficient = damping->find("coefficient"))
      coefficient->fail("'coefficient' is that of a bond of one pitch", "give 'ratio'");
  for (const ConfigTable& constraint : root.tables("constraint"))
    for (const char* key : {"kp", "kd"})
      if (const auto gain = constraint.find(key))
        gain->fail(fmt::format("'{}' is that of a particle of one pitch", key), "leave it out");
  if (const std::vector<ConfigTable> listed = root.tables("particle"); !listed.empty())
    listed.front().fail("a particle has the mass of one pitch", "a shape of a material of its own");
  check_mass(root);
  if (const auto rule = root.find("rule"))
    check_rule(*rule, base);
  else
    check_law(root.at("law").table());
  for (const ConfigTable& bond : root.tables("bond"))
    if (const auto law = bond.table_at("law")) check_law(*law);
  for (const ConfigTable& material : root.tables("material")) check_mass(material);
  const ConfigTable run = root.at("run").table();
  if (const auto steps = run.find("steps"))
    steps->fail("so many steps are another time at another pitch", "give 'duration'");
  if (const auto dt = run.find("dt");
      dt && !(dt->is_string() && dt->string() == "auto") && !run.has("static"))
    dt->fail("'dt' is stable at one pitch", "dt = \"auto\"");
  if (const auto stage = root.find("stage")) stage->fail("a scene with stages is not refined");
  if (const auto start = root.find("start")) start->fail("a state to begin from has a pitch of its own");
  const std::array<bool, 3> live = live_axes(resolve(base, {}).scene);
  if (!(live[0] && live[1] && live[2]))
    root.at("geometry")
        .fail("all particles stand in one plane: a layer is as thick as its pitch",
              "a plate of several layers");
}

Vec3 shift_of(int k) {
  constexpr double kRoot = 1.2207440846057594;  // of x^4 = x + 1
  Vec3 shift;
  for (int a = 0; a < 3; ++a)
    shift[a] = k * std::pow(kRoot, -1 - a) - std::floor(k * std::pow(kRoot, -1 - a));
  return shift;
}

double PitchLine::error_at(double pitch) const {
  if (limit == 0) return std::numeric_limits<double>::infinity();
  return ((std::abs(slope) + scatter) * pitch + limit_within) / std::abs(limit);
}

std::optional<double> PitchLine::pitch_for(double error) const {
  const double left = error * std::abs(limit) - limit_within;
  if (!(left > 0)) return std::nullopt;
  return left / (std::abs(slope) + scatter);
}

PitchLine line_through(const std::vector<PitchRun>& runs) {
  const auto n = static_cast<double>(runs.size());
  double x = 0, y = 0, xx = 0, xy = 0, rest = 0;
  for (const PitchRun& run : runs) x += 1 / run.pitch / n, y += run.value / run.pitch / n;
  for (const PitchRun& run : runs) {
    xx += (1 / run.pitch - x) * (1 / run.pitch - x);
    xy += (1 / run.pitch - x) * (run.value / run.pitch - y);
  }
  PitchLine line;
  line.limit = xy / xx;
  line.slope = y - line.limit * x;
  for (const PitchRun& run : runs) rest += std::pow((run.value - line.limit) / run.pitch - line.slope, 2);
  line.scatter = within_90(runs.size() - 2) * std::sqrt(rest / (n - 2));
  line.limit_within = line.scatter / std::sqrt(xx);
  return line;
}

PitchAnswer find_pitch(const PitchQuestion& question, const std::string& directory,
                       const std::function<void(const PitchAnswer&)>& see) {
  std::vector<PitchRun> known;
  KeptLines kept(
      directory + "/runs.jsonl", hash_of(question), "another scene or figure",
      [&](const nlohmann::json& line) {
        known.push_back({line.at("pitch"), line.at("shift"), line.at("particles"), line.at("value"),
                         line.at("unit"), line.at("particle_steps"), line.at("seconds")});
      });
  const Packings packings(question.base);
  PitchAnswer answer;
  for (double pitch = packings.first();; pitch = std::stod(written(pitch * kFiner))) {
    if (!answer.runs.empty() && static_cast<double>(answer.runs.back().particles) * std::pow(kFiner, -3) >
                                    static_cast<double>(question.most_particles))
      return answer;
    std::vector<Case> cases;
    uint64_t most = 0;
    for (int shift = 0; shift < packings.shifts(); ++shift) {
      cases.push_back(resolve(question.base, packings.at(pitch, shift)));
      most = std::max<uint64_t>(most, cases.back().scene.body.size());
    }
    if (most > question.most_particles) {
      if (pitch < packings.first()) return answer;
      cases.front().scene.places.fail(
          {"packing.pitch"},
          fmt::format("the scene's own pitch makes {} particles: more than the {} that are allowed", most,
                      question.most_particles),
          fmt::format("--particles {}, or a larger pitch in the scene", most));
    }
    for (int shift = 0; shift < packings.shifts(); ++shift) {
      const auto was = std::ranges::find_if(
          known, [&](const PitchRun& run) { return run.pitch == pitch && run.shift == shift; });
      if (was == known.end()) {
        answer.runs.push_back(run_at(question, cases[static_cast<size_t>(shift)], shift));
        kept.add(line_of(answer.runs.back()));
        kept.save();
      } else {
        answer.runs.push_back(*was);
      }
    }
    if (answer.runs.size() >= kLeastRuns && pitch < packings.first()) {
      answer.line = line_through(answer.runs);
      answer.pitch = answer_of(question, answer.runs, *answer.line);
    }
    see(answer);
    if (answer.pitch) return answer;
  }
}

}  // namespace cuboct::study
