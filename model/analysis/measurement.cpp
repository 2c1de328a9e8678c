// SPDX-License-Identifier: MIT
#include "model/analysis/measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "model/analysis/common_neighbours.h"
#include "model/analysis/displacement.h"
#include "model/analysis/near_within.h"
#include "model/analysis/particle_stress.h"
#include "model/analysis/radial_distribution.h"
#include "model/base/error.h"
#include "model/base/spelling.h"
#include "model/contract/material_name.h"
#include "model/rules/rounds_rule.h"
#include "model/solid/dynamical_matrix.h"
#include "model/trace/frame.h"

namespace cuboct {
namespace {

constexpr uint64_t kBins = 200;
// Of the nearest distance: g(r) to the fourth shell of a close packing, and no shell at a bin's end; where
// twelve nearest are found.
constexpr double kRdfReach = 4.1, kCnaReach = 2;

bool all_periodic(const Scene& scene) { return scene.periodic.extent.minCoeff() > 0; }

// m, about the distance of nearest neighbours: the pitch; else that of a close packing of the box's density;
// else half the cutoff.
double spacing(const Scene& scene) {
  if (scene.pitch > 0) return scene.pitch;
  if (all_periodic(scene) && scene.body.size() > 0)
    return std::cbrt(std::sqrt(2.0) * scene.periodic.extent.prod() / static_cast<double>(scene.body.size()));
  return scene.rule.cutoff() / 2;
}

// At most what periods allow: those of both boxes.
double within_box(double range, const Periodic& periodic, const Periodic& other) {
  for (int axis = 0; axis < 3; ++axis)
    if (periodic.extent[axis] > 0)
      range = std::min({range, periodic.extent[axis] / 2, other.extent[axis] / 2});
  return range;
}
double within_box(double range, const Periodic& periodic) { return within_box(range, periodic, periodic); }

std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const ParticleType& type : scene.rule.types)
    if (const std::string name = material_of(type.name); std::ranges::find(names, name) == names.end())
      names.push_back(name);
  return names;
}

// By id, whether the particle is of the material.
std::vector<char> particles_of(const Scene& scene, const std::string& material) {
  const std::vector<std::string> names = material_names(scene);
  if (std::ranges::find(names, material) == names.end()) {
    const std::string near = did_you_mean(material, names);
    throw InputError(fmt::format("no material '{}'", material), near.empty() ? list_of(names) : near);
  }
  std::vector<char> belongs;
  for (const uint8_t type : scene.body.type)
    belongs.push_back(material_of(scene.rule.types[type].name) == material);
  return belongs;
}

// Of any of the materials; empty: all.
std::vector<char> counted(const Scene& scene, const std::vector<std::string>& materials) {
  std::vector<char> any;
  for (const std::string& material : materials) {
    const std::vector<char> one = particles_of(scene, material);
    any.resize(one.size());
    for (size_t i = 0; i < one.size(); ++i) any[i] |= one[i];
  }
  return any;
}

// "1.5 m"; of a scene in reduced units "1.5".
std::string told(const Scene& scene, double value, const std::string& unit) {
  return fmt::format("{:.6g}{}", value, scene.boltzmann == 1 ? "" : " " + unit);
}

struct Volume {
  double value;  // m^3
  std::string of;
  bool fills = true;  // the particles, without a surface
  bool box = false;   // that of each frame's box
  double at(const Scene& scene, uint64_t step) const {
    return box ? scene.box_at(step).extent.prod() : value;
  }
};

Volume volume_of(const Scene& scene, const MeasureChoice& choice) {
  if (choice.volume) return {*choice.volume, choice.option + "volume", all_periodic(scene)};
  if (all_periodic(scene)) return {scene.periodic.extent.prod(), "the periodic box", true, scene.deforms()};
  const bool atoms = scene.rule.rounds && !scene.rule.rounds->element().empty();
  if (scene.pitch == 0 || atoms)
    throw InputError("the body's volume is not known: its box does not repeat along x, y and z",
                     choice.option + "volume says it: '1 mm^3'");
  return {static_cast<double>(scene.body.size()) * fcc_volume(scene.pitch), "the particles as packed", false};
}

// Columns "step" and, but of static loading, "time", then others, a row for each frame.
class Rows : public Measure {
 public:
  explicit Rows(const Scene& scene) : scene_(scene) {
    columns_ = {{"step", "1", true}};
    if (!scene.loading) columns_.push_back({"time", "s"});
    own_ = columns_.size();
  }
  const MeasuredParticles* particles() const override { return &particles_; }
  Measured result() override { return {notes_, columns_}; }

 protected:
  void column(const std::string& name, const std::string& unit, bool whole = false) {
    columns_.push_back({name, unit, whole});
  }
  void note(const std::string& name, const std::string& text) { notes_.emplace_back(name, text); }
  void row(const Snapshot& now, const std::vector<double>& values) {
    const auto step = static_cast<double>(now.step);
    columns_[0].values.push_back(step);
    if (own_ == 2) columns_[1].values.push_back(step * scene_.rule.dt);
    for (size_t k = 0; k < values.size(); ++k) columns_[own_ + k].values.push_back(values[k]);
  }

  const Scene& scene_;
  MeasuredParticles particles_;
  std::vector<MeasuredColumn> columns_;
  size_t own_ = 0;  // columns before the measure's own
  std::vector<std::pair<std::string, std::string>> notes_;
};

class RdfMeasure : public Measure {
 public:
  RdfMeasure(const Scene& scene, const MeasureChoice& choice)
      : scene_(scene), choice_(choice), volume_(volume_of(scene, choice)), meter_(meter_of(scene, choice)) {}

  void add(const Snapshot& now) override {
    meter_.set_box(scene_.box_at(now.step));
    meter_.add(now.body.x);
    inverse_volume_ += 1 / volume_.at(scene_, now.step);
    ++frames_;
  }
  Measured result() override {
    // Densities of frames have a mean, not their volumes.
    const double volume =
        volume_.box && frames_ > 0 ? static_cast<double>(frames_) / inverse_volume_ : volume_.value;
    const Rdf rdf = meter_.result(volume);
    Measured out;
    const double number = static_cast<double>(scene_.body.size());
    const double cutoff = rdf.width * static_cast<double>(rdf.g.size());
    out.notes = {
        {"cutoff", fmt::format("{} in {} bins", told(scene_, cutoff, "m"), rdf.g.size())},
        {"density", fmt::format("{}: {} particles over the volume of {}",
                                told(scene_, number / volume, "1/m^3"), scene_.body.size(), volume_.of)}};
    const auto last =
        std::find_if(rdf.pairs.rbegin(), rdf.pairs.rend(), [](auto pairs) { return pairs > 0; });
    const double farthest = rdf.width * static_cast<double>(rdf.pairs.rend() - last);
    if (farthest < cutoff / 2)
      out.notes.emplace_back(
          "empty",
          last == rdf.pairs.rend()
              ? "no two particles are within the cutoff"
              : fmt::format("no two particles within the cutoff are farther apart than {}: a shorter "
                            "one has finer bins",
                            told(scene_, farthest, "m")));
    if (!volume_.fills)
      out.notes.emplace_back(
          "surfaces", "g(r) falls below 1 with r, as particles at the surface have neighbours on one side");
    if (!choice_.types.empty())
      out.notes.emplace_back("pairs", fmt::format("of {} about {}", choice_.types[1], choice_.types[0]));
    out.columns = {{"r", "m"}, {"g", "1"}, {"within", "1"}, {"pairs", "1", true}};
    for (size_t bin = 0; bin < rdf.g.size(); ++bin) {
      out.columns[0].values.push_back(rdf.middle(bin));
      out.columns[1].values.push_back(rdf.g[bin]);
      out.columns[2].values.push_back(rdf.within[bin]);
      out.columns[3].values.push_back(static_cast<double>(rdf.pairs[bin]));
    }
    return out;
  }

 private:
  static RdfMeter meter_of(const Scene& scene, const MeasureChoice& choice) {
    RdfSets sets;
    if (choice.types.size() == 1 || choice.types.size() > 2)
      throw InputError(
          fmt::format("{}types of rdf names two materials, not {}", choice.option, choice.types.size()),
          "A,B: those of B about those of A; A,A of one with itself");
    if (!choice.types.empty())
      sets = {particles_of(scene, choice.types[0]), particles_of(scene, choice.types[1])};
    const double cutoff = choice.cutoff.value_or(
        within_box(kRdfReach * spacing(scene), scene.periodic, scene.box_at(scene.steps)));
    return {scene.periodic, cutoff, choice.bins.value_or(kBins), std::move(sets), choice.threads};
  }

  const Scene& scene_;
  const MeasureChoice choice_;
  const Volume volume_;
  RdfMeter meter_;
  double inverse_volume_ = 0;  // 1/m^3, summed over frames
  size_t frames_ = 0;
};

class MsdMeasure : public Rows {
 public:
  MsdMeasure(const Scene& scene, const MeasureChoice& choice)
      : Rows(scene), counted_(counted(scene, choice.types)) {
    for (const char* name : {"msd", "x", "y", "z"}) column(name, "m^2");
    if (choice.com)
      for (const uint8_t type : scene.body.type) masses_.push_back(scene.rule.mass_of(type));
    note("drift", choice.com ? "the centre of mass's motion is taken off"
                             : "the centre of mass's motion counts; " + choice.option + "com takes it off");
    particles_ = {"displacement", "m", kVectorNames};
  }

  void add(const Snapshot& now) override {
    if (!meter_) {
      meter_.emplace(scene_.periodic, now.wrapped);
      notes_.emplace(notes_.begin(), "from", fmt::format("step {}", now.step));
    }
    // A box that deforms carries its particles: that way counts. Its frames are not wrapped.
    // Of a rule with noise or bonds the mean velocity tells nothing of the way: it does not last.
    meter_->add(now.step, now.body.x, scene_.rule.rounds ? std::vector<Vec3>() : now.body.v, scene_.rule.dt);
    const Vec3 squares = mean_squared(meter_->moved(), counted_, masses_);
    row(now, {squares.sum(), squares[0], squares[1], squares[2]});
    particles_.values.clear();
    for (const Vec3& one : meter_->moved())
      particles_.values.insert(particles_.values.end(), one.begin(), one.end());
  }

 private:
  const std::vector<char> counted_;
  std::vector<double> masses_;
  std::optional<DisplacementMeter> meter_;
};

class CoordinationMeasure : public Rows {
 public:
  CoordinationMeasure(const Scene& scene, const MeasureChoice& choice)
      : Rows(scene), choice_(choice), counted_(counted(scene, choice.types)) {
    column("mean", "1");
    particles_ = {"coordination", "1", {}, true};
    if (choice.cutoff)
      cut_at(*choice.cutoff, "as given");
    else if (scene.pitch > 0)
      cut_at(first_shell(scene), "between the packing's first and second shell");
  }

  void add(const Snapshot& now) override {
    const Body& body = now.body;
    const Periodic box = scene_.box_at(now.step);
    if (cutoff_ == 0) {
      RdfMeter meter(box, within_box(kRdfReach * spacing(scene_), box), kBins, {}, choice_.threads);
      meter.add(body.x);
      const double least = first_minimum(meter.result(1));
      if (least == 0)
        throw InputError("no cutoff is known: g(r) of the first frame has no minimum behind a peak",
                         choice_.option + "cutoff says it");
      cut_at(least, fmt::format("first minimum of g(r) of step {}", now.step));
    }
    std::vector<double>& of = particles_.values;
    of.assign(body.size(), 0);
    check_range(cutoff_, box, "cutoff");
    for_each_near(body.x, box, cutoff_, choice_.threads,
                  [&](size_t, uint32_t i, std::span<const uint32_t> near) {
                    of[i] = static_cast<double>(near.size());
                  });
    std::vector<double> values{0};
    double number = 0;
    for (size_t i = 0; i < of.size(); ++i) {
      if (!counted_.empty() && !counted_[i]) continue;
      const auto count = static_cast<size_t>(of[i]);
      if (values.size() < count + 2) values.resize(count + 2);
      values[0] += of[i], ++values[count + 1], ++number;
    }
    if (number > 0) values[0] /= number;
    for (size_t count = columns_.size() - own_ - 1; count + 1 < values.size(); ++count) {
      column(std::to_string(count), "1", true);
      columns_.back().values.assign(columns_[0].values.size(), 0);
    }
    values.resize(columns_.size() - own_);
    row(now, values);
  }

 private:
  void cut_at(double cutoff, const std::string& why) {
    check_range(cutoff, scene_.periodic, "cutoff");
    cutoff_ = cutoff;
    note("cutoff", fmt::format("{}, {}", told(scene_, cutoff, "m"), why));
  }

  const MeasureChoice choice_;
  const std::vector<char> counted_;
  double cutoff_ = 0;  // m; 0: not known yet
};

class CnaMeasure : public Rows {
 public:
  CnaMeasure(const Scene& scene, const MeasureChoice& choice)
      : Rows(scene),
        choice_(choice),
        counted_(counted(scene, choice.types)),
        reach_(within_box(kCnaReach * spacing(scene), scene.periodic)) {
    for (int k = 1; k <= kStructures; ++k)
      column(to_string(static_cast<Structure>(k % kStructures)), "1", true);
    particles_ = {"structure", "1", {}, true};
    if (choice.cutoff) check_range(*choice.cutoff, scene.periodic, "cutoff");
    note("method", choice.cutoff ? "neighbours within " + told(scene, *choice.cutoff, "m")
                                 : "adaptive: the nearest 12 or 14 within " + told(scene, reach_, "m"));
    note("structure", "0 other, 1 fcc, 2 hcp, 3 bcc, 4 icosahedral");
  }

  void add(const Snapshot& now) override {
    const std::vector<Vec3>& x = now.body.x;
    const Periodic box = scene_.box_at(now.step);
    const std::vector<Structure> of =
        choice_.cutoff ? structures_within(x, box, *choice_.cutoff, choice_.threads)
                       : structures_adaptive(x, box, within_box(reach_, box), choice_.threads);
    std::vector<double> counts(kStructures, 0);
    particles_.values.clear();
    for (size_t i = 0; i < of.size(); ++i) {
      const auto number = static_cast<size_t>(of[i]);
      particles_.values.push_back(static_cast<double>(number));
      if (counted_.empty() || counted_[i]) ++counts[(number + kStructures - 1) % kStructures];
    }
    row(now, counts);
  }

 private:
  const MeasureChoice choice_;
  const std::vector<char> counted_;
  const double reach_;  // m
};

class StressMeasure : public Rows {
 public:
  StressMeasure(const Scene& scene, const MeasureChoice& choice)
      : Rows(scene),
        counted_(counted(scene, choice.types)),
        volume_(volume_of(scene, choice)),
        kinetic_(!choice.virial && !scene.loading),
        stress_(scene, choice.threads) {
    for (const std::string& name : kTensorNames) column(name, "Pa");
    column("pressure", "Pa");
    particles_ = {"stress_volume", "J", kTensorNames};
    note("volume", volume_.box ? "of the periodic box of each frame"
                               : fmt::format("{}, of {}", told(scene, volume_.value, "m^3"), volume_.of));
    note("kinetic part",
         kinetic_ ? "counts; " + choice.option + "virial leaves it out" : std::string("left out"));
    note("sign", "stress is positive in tension; pressure is minus a third of its trace");
  }

  void add(const Snapshot& now) override {
    const double volume = volume_.at(scene_, now.step);
    stress_.set_box(scene_.box_at(now.step));
    const std::vector<Mat3> of = stress_.of(now.body, kinetic_, now.late);
    std::vector<double> sum(7, 0);
    particles_.values.clear();
    for (size_t i = 0; i < of.size(); ++i)
      for (size_t k = 0; k < 6; ++k) {
        const double value = of[i](kTensorPlaces[k].first, kTensorPlaces[k].second);
        particles_.values.push_back(value);
        if (counted_.empty() || counted_[i]) sum[k] += value / volume;
      }
    sum[6] = -(sum[0] + sum[1] + sum[2]) / 3;
    row(now, sum);
  }

 private:
  const std::vector<char> counted_;
  const Volume volume_;
  const bool kinetic_;
  ParticleStress stress_;
};

void refuse_option(const std::string& measure, const std::string& option, bool given,
                   std::initializer_list<const char*> measures) {
  const std::vector<std::string> those(measures.begin(), measures.end());
  if (given && std::ranges::find(those, measure) == those.end())
    throw InputError(fmt::format("{} is not an option of {}", option, measure),
                     fmt::format("it is one of {}", list_of(those)));
}

}  // namespace

const std::vector<std::string>& measure_names() {
  static const std::vector<std::string> names{"rdf", "msd", "coordination", "cna", "stress"};
  return names;
}

const char* usual_frames(const std::string& name) { return name == "rdf" ? "half" : "all"; }

std::unique_ptr<Measure> make_measure(const std::string& name, const Scene& scene,
                                      const MeasureChoice& choice) {
  const std::vector<std::string>& names = measure_names();
  if (std::ranges::find(names, name) == names.end()) {
    const std::string near = did_you_mean(name, names);
    throw InputError(fmt::format("no measure '{}'", name), near.empty() ? list_of(names) : near);
  }
  refuse_option(name, choice.option + "bins", choice.bins.has_value(), {"rdf"});
  refuse_option(name, choice.option + "cutoff", choice.cutoff.has_value(), {"rdf", "coordination", "cna"});
  refuse_option(name, choice.option + "volume", choice.volume.has_value(), {"rdf", "stress"});
  refuse_option(name, choice.option + "com", choice.com, {"msd"});
  refuse_option(name, choice.option + "virial", choice.virial, {"stress"});
  if (name == "rdf") return std::make_unique<RdfMeasure>(scene, choice);
  if (name == "msd") return std::make_unique<MsdMeasure>(scene, choice);
  if (name == "coordination") return std::make_unique<CoordinationMeasure>(scene, choice);
  if (name == "cna") return std::make_unique<CnaMeasure>(scene, choice);
  return std::make_unique<StressMeasure>(scene, choice);
}

namespace {

[[noreturn]] void refuse_frames(const std::string& text, const std::vector<uint64_t>& steps) {
  std::string kept;
  for (size_t k = 0; k < steps.size(); ++k)
    if (k < 8 || k + 1 == steps.size())
      kept += fmt::format("{}{}", k == 0 ? "" : k >= 8 && steps.size() > 9 ? ", ..., " : ", ", steps[k]);
  throw InputError(
      fmt::format("no frames '{}'", text),
      fmt::format("all, half, last, steps as 0,500 or from one step to another as 100:900; kept are {}",
                  kept));
}

std::optional<uint64_t> whole(std::string_view text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::vector<size_t> chosen_frames(const std::vector<uint64_t>& steps, const std::string& text) {
  std::vector<size_t> all(steps.size());
  std::iota(all.begin(), all.end(), size_t{0});
  if (text == "all") return all;
  if (text == "half") return {all.begin() + static_cast<ptrdiff_t>(all.size() / 2), all.end()};
  if (text == "last") return {all.end() - 1, all.end()};
  std::vector<size_t> chosen;
  if (const size_t colon = text.find(':'); colon != std::string::npos) {
    const std::string_view from = std::string_view(text).substr(0, colon),
                           to = std::string_view(text).substr(colon + 1);
    const std::optional<uint64_t> first = from.empty() ? 0 : whole(from),
                                  last = to.empty() ? UINT64_MAX : whole(to);
    if (!first || !last) refuse_frames(text, steps);
    for (const size_t k : all)
      if (steps[k] >= *first && steps[k] <= *last) chosen.push_back(k);
  } else {
    for (size_t begin = 0; begin <= text.size();) {
      const size_t end = std::min(text.find(',', begin), text.size());
      const std::optional<uint64_t> step = whole(std::string_view(text).substr(begin, end - begin));
      const auto at = step ? std::ranges::find(steps, *step) : steps.end();
      if (at == steps.end()) refuse_frames(text, steps);
      chosen.push_back(static_cast<size_t>(at - steps.begin()));
      begin = end + 1;
    }
    std::ranges::sort(chosen);
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  }
  if (chosen.empty()) refuse_frames(text, steps);
  return chosen;
}

}  // namespace cuboct
