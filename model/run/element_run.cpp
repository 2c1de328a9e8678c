// SPDX-License-Identifier: MIT
#include "model/run/element_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "model/atoms/multiscale/element_stiffness.h"
#include "model/base/clock.h"
#include "model/run/element_progress.h"

namespace cuboct {
namespace {

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A set of grains, from where its progress is to its end.
class SetRun {
 public:
  SetRun(const ElementStudy& study, const std::shared_ptr<const SampleMaterial>& material,
         const ElementRunOptions& options, ElementProgressFile& file)
      : study_(study), material_(material), options_(options), file_(file), now_(file.now) {}

  void run() {
    if (study_.stretch && !now_.waving) stretch();
    if (study_.wave) wave();
    count_time();
    file_.done.push_back(std::move(now_.outcome));
    now_ = {};
    save();
  }

 private:
  ElementBody body() {
    ElementBody out = body_of(study_, material_, file_.done.size(), options_.threads, options_.relaxer);
    if (now_.begun) {
      out.x() = now_.x, out.period() = now_.period;
      out.restore(now_.samples, now_.outcome.work);
    } else {
      out.restore(out.samples(), now_.outcome.work);
    }
    return out;
  }

  void take(const ElementBody& body) {
    now_.x = body.x(), now_.period = body.period(), now_.samples = body.samples();
    now_.outcome.work = body.work();
    now_.begun = true;
  }

  void stretch() {
    const StretchInput& input = *study_.stretch;
    ElementBody body = this->body();
    Stretch stretch(body, input.axis);
    std::vector<StretchPoint>& points = now_.outcome.stretch;
    while (points.size() < input.strains.size()) {
      points.push_back(stretch.to(input.strains[points.size()]));
      go_on(body, share() * static_cast<double>(points.size()) / static_cast<double>(input.strains.size()),
            [] {});
    }
    now_.outcome.moduli = moduli_of(points);
    now_.outcome.work = body.work();
    now_.begun = false;  // the wave has a body of its own
  }

  // Of a set that has both, half each.
  double share() const { return study_.stretch && study_.wave ? 0.5 : 1; }

  void wave() {
    const WaveInput& input = *study_.wave;
    now_.waving = true;
    ElementBody body = this->body();
    const WaveSlices slices(body, input.axis);
    const double expected = expected_speed(hill_mean(material_->constants), material_->lattice.density(),
                                           {input.axis, input.polarisation}, study_.mesh.period);
    const double crossing = slices.length() / expected, pulse = input.pulse.value_or(crossing / 4);
    WaveOutcome& out = now_.outcome.wave;
    out.dt = input.step * 2 / fastest_vibration(body, element_stiffness(body));
    const auto steps = static_cast<uint64_t>(std::ceil(input.duration.value_or(crossing) / out.dt));
    ElementMotion motion(body, out.dt,
                         load_of(study_.mesh, {input.axis, input.polarisation, input.peak, pulse}));
    if (now_.history.empty()) {
      now_.history.push_back(slices.velocities(motion, input.polarisation));
    } else {
      motion.v() = now_.v;
      motion.restore(now_.steps);
      body.restore(now_.samples, now_.outcome.work);
    }
    while (motion.steps() < steps) {
      motion.step();
      now_.steps = motion.steps();
      now_.history.push_back(slices.velocities(motion, input.polarisation));
      snap(motion, body, out);
      go_on(body, 1 - share() + share() * static_cast<double>(motion.steps()) / static_cast<double>(steps),
            [&] { now_.v = motion.v(); });
    }
    out.steps = steps;
    finish(slices, pulse * expected, out);
    now_.outcome.work = body.work();
  }

  // The front is followed from where the whole pulse has come in to where its reflection from the end is not
  // felt yet.
  void finish(const WaveSlices& slices, double pulse, WaveOutcome& out) const {
    // A slice may lie on an end of that stretch: no rounding is to leave it out.
    const double edge = 1e-6 * slices.width();
    out.front = front_of(slices, now_.history, out.dt, pulse - edge, slices.length() - pulse + edge);
    try {
      out.speed = speed_of(out.front);
    } catch (const InputError& error) {
      throw study_.places.placed(error.about({"mesh.size", "mesh.file", "mesh"}));
    }
    double most = 0;
    for (const auto& row : now_.history)
      for (size_t s = row.size() / 4; s < row.size() * 3 / 4; ++s) most = std::max(most, std::abs(row[s]));
    out.largest_strain = most / out.speed.speed;
  }

  void snap(const ElementMotion& motion, const ElementBody& body, WaveOutcome& out) const {
    const WaveInput& input = *study_.wave;
    if (!file_.done.empty() || out.snapshots.size() >= input.snapshots.size()) return;
    if (motion.time() + out.dt / 2 < input.snapshots[out.snapshots.size()]) return;
    const int across = (input.axis + 1) % 3, face = (input.axis + 2) % 3;
    double low = body.mesh().x[0][face], high = low;
    for (const Vec3& x : body.mesh().x) low = std::min(low, x[face]), high = std::max(high, x[face]);
    WaveSnapshot snapshot{motion.time(), {}};
    for (size_t v = 0; v < body.x().size(); ++v) {
      const Vec3& x = body.mesh().x[v];
      if (x[face] - low <= 1e-6 * (high - low))
        snapshot.points.push_back({x[input.axis], x[across], motion.v()[v][input.polarisation]});
    }
    out.snapshots.push_back(std::move(snapshot));
  }

  template <typename Rest>
  void go_on(const ElementBody& body, double part, const Rest& rest) {
    const bool stops = !options_.see(file_.done.size(), part);
    if (!stops && seconds_since(saved_) < options_.save_every) return;
    if (!options_.progress.empty()) {
      take(body);
      rest();
      count_time();
      save();
    }
    if (stops) throw ElementRunStopped();
  }

  void count_time() {
    now_.outcome.seconds += seconds_since(began_);
    now_.outcome.processor += processor_seconds() - processor_began_;
    began_ = Clock::now(), processor_began_ = processor_seconds();
  }

  void save() {
    if (!options_.progress.empty()) save_progress(options_.progress, study_.hash, file_);
    saved_ = Clock::now();
  }

  const ElementStudy& study_;
  std::shared_ptr<const SampleMaterial> material_;
  const ElementRunOptions& options_;
  ElementProgressFile& file_;
  ElementProgress& now_;
  Clock::time_point began_ = Clock::now(), saved_ = began_;
  double processor_began_ = processor_seconds();
};

}  // namespace

std::string set_status(size_t set, size_t sets, double part) {
  return fmt::format("set {} of {}: {:.0f} %", set + 1, sets, 100 * part);
}

std::vector<SetOutcome> run_elements(const ElementStudy& study,
                                     const std::shared_ptr<const SampleMaterial>& material,
                                     const ElementRunOptions& options) {
  ElementProgressFile file;
  if (!options.progress.empty()) file = load_progress(options.progress, study.hash);
  while (file.done.size() < study.sets) SetRun(study, material, options, file).run();
  return std::move(file.done);
}

}  // namespace cuboct
