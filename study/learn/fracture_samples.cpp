// SPDX-License-Identifier: MIT

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "model/atoms/bond_order/atom_motion.h"
#include "model/base/error.h"
#include "study/learn/fracture_samples.h"
#include "study/sweep/thread_time.h"

namespace cuboct::learn {
namespace {

// Without what hangs by one bond, or none, as atoms at a cut edge may.
void drop_loose(std::vector<Vec3>& x, double reach) {
  for (bool dropped = true; dropped;) {
    std::vector<int> near(x.size());
    for (size_t i = 0; i < x.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (std::abs(x[i][0] - x[j][0]) < reach && (x[i] - x[j]).norm() < reach) ++near[i], ++near[j];
    std::vector<Vec3> kept;
    for (size_t i = 0; i < x.size(); ++i)
      if (near[i] > 1) kept.push_back(x[i]);
    dropped = kept.size() < x.size();
    x = std::move(kept);
  }
}

// The sheet with free edges, symmetric about x = 0, and a slit along y from its lower edge: the column of
// atoms at x = 0 is left out, so that the faces are out of each other's reach.
std::vector<Vec3> slit_sheet(const LearnStudy& study, const AtomCell& sheet) {
  const Vec3 extent = sheet.box.edges.diagonal();
  SheetInput larger = study.sheet;
  for (int& cells : larger.cells) cells += 4;
  std::vector<Vec3> out;
  const double little = 1e-6 * study.sheet.bond;
  for (const Vec3& x : resting_sheet(larger).x) {
    if (std::abs(x[0]) > extent[0] / 2 + little || std::abs(x[1]) > extent[1] / 2 + little) continue;
    if (std::abs(x[0]) < little && x[1] < study.fracture.slit - extent[1] / 2) continue;
    out.push_back(x);
  }
  drop_loose(out, 1.2 * study.sheet.bond);
  return out;
}

class Run {
 public:
  Run(const LearnStudy& study, const AtomCell& sheet, FractureLoad load)
      : study_(study),
        input_(study.fracture),
        load_(load),
        extent_(sheet.box.edges.diagonal()),
        motion_(study.sheet.tersoff, system(sheet), {.dt = 0, .skin = 0.4}) {
    if (!motion_.rest(study.still.force).reached)
      throw std::runtime_error("the sheet with its slit comes to no rest");
    home_ = motion_.atoms().x;
    AtomSystem resting = motion_.atoms();
    resting.v = load == FractureLoad::pulled ? pull(home_) : std::vector<Vec3>(home_.size(), Vec3::Zero());
    // Frames are whole numbers of steps.
    per_frame_ = static_cast<uint64_t>(std::ceil(input_.interval / input_.dt - 1e-9));
    motion_ = AtomMotion(study.sheet.tersoff, resting,
                         {.dt = input_.interval / static_cast<double>(per_frame_), .skin = 0.4});
    for (const Grid& grid : fracture_grids(study, sheet)) {
      grains_.emplace_back(grid.coarse(false), scaled(home_, kAngstrom),
                           std::vector<double>(home_.size(), mass()));
      out_.density.push_back(grains_.back().density());
      out_.velocity.push_back(grains_.back().linear_mean(scaled(motion_.atoms().v, kAngstrom / kPicosecond)));
    }
    out_.frames.resize(grains_.size());
  }

  FractureSample run(const std::function<void(int)>& see) {
    for (int frame = 0; frame <= input_.frames; ++frame) {
      const double begin = study::thread_seconds();
      if (frame > 0) step();
      out_.seconds += study::thread_seconds() - begin;
      keep(frame);
      see(frame);
    }
    return std::move(out_);
  }

 private:
  double mass() const {
    return study_.sheet.mass * kElectronVolt * kPicosecond * kPicosecond / (kAngstrom * kAngstrom);
  }
  double time() const {
    return static_cast<double>(motion_.steps()) * input_.interval / static_cast<double>(per_frame_);
  }

  AtomSystem system(const AtomCell& sheet) const {
    AtomBox box = sheet.box;
    box.periodic = {false, false, false};
    return {box, slit_sheet(study_, sheet), {}, {}, {study_.sheet.mass}};
  }
  static std::vector<Vec3> scaled(std::vector<Vec3> items, double by) {
    for (Vec3& item : items) item *= by;
    return items;
  }

  // From the middle to the edges, and from the bottom to the top, linear: the sheet begins with the speeds of
  // its edges' pull, so that no shock leaves them.
  std::vector<Vec3> pull(const std::vector<Vec3>& x) const {
    std::vector<Vec3> v;
    for (const Vec3& at : x)
      v.emplace_back(input_.velocity * at[0] / (extent_[0] / 2) * (0.5 - at[1] / extent_[1]), 0, 0);
    return v;
  }

  // Of the test, at the time: section 5.1.
  std::vector<Vec3> push() const {
    const double fade = std::exp(-time() / input_.duration);
    std::vector<Vec3> force;
    for (const Vec3& at : home_)
      force.emplace_back(input_.push * fade * (1 - fade) * std::sin(std::numbers::pi * at[0] / extent_[0]) *
                             std::exp(-(0.5 + at[1] / extent_[1])),
                         0, 0);
    return force;
  }

  AtomLoads loads() const {
    AtomLoads loads;
    if (load_ == FractureLoad::pushed) {
      loads.force = push();
    } else {
      const double edge = extent_[0] / 2 - input_.grip;
      for (const Vec3& at : home_) loads.imposed.push_back({std::abs(at[0]) > edge, false, false});
      loads.velocity = pull(home_);
    }
    return loads;
  }

  // One frame on. A pulse changes slowly: its force is set anew a few times within.
  void step() {
    constexpr uint64_t kTurns = 10;
    for (uint64_t turn = 0; turn < kTurns; ++turn) {
      motion_.load(loads());
      motion_.step(per_frame_ * (turn + 1) / kTurns - per_frame_ * turn / kTurns);
    }
  }

  void keep(int frame) {
    std::vector<Vec3> u = motion_.atoms().x, force = motion_.forces();
    std::vector<Vec3> b = load_ == FractureLoad::pushed ? push() : std::vector<Vec3>(u.size(), Vec3::Zero());
    for (size_t i = 0; i < u.size(); ++i) {
      u[i] = (u[i] - home_[i]) * kAngstrom;
      b[i] *= kElectronVolt / kAngstrom;
      force[i] = (force[i] * kElectronVolt / kAngstrom + b[i]) / mass();
    }
    const CrackSight sight{study_.grid.noise * kAngstrom, study_.grid.tube * kAngstrom};
    for (size_t g = 0; g < grains_.size(); ++g) {
      grains_[g].look(u, sight);
      out_.frames[g].push_back({grains_[g].linear_mean(u), grains_[g].mean(force), grains_[g].density_of(b)});
    }
    const int half = input_.frames / 2, quarter = input_.frames / 4;
    if (frame == half || frame == half + quarter || frame == input_.frames)
      out_.atoms.push_back({frame, scaled(home_, kAngstrom), u});
  }

  const LearnStudy& study_;
  const FractureInput& input_;
  const FractureLoad load_;
  const Vec3 extent_;
  AtomMotion motion_;
  std::vector<Vec3> home_;
  uint64_t per_frame_ = 0;
  std::vector<CoarseGrain> grains_;
  FractureSample out_;
};

}  // namespace

std::vector<Grid> fracture_grids(const LearnStudy& study, const AtomCell& sheet) {
  std::vector<Grid> grids;
  for (const int points : {study.grid.points, study.grid.fine_points, study.grid.coarse_points})
    grids.push_back(grid_of(study, sheet, points));
  return grids;
}

FractureSample fracture(const LearnStudy& study, const AtomCell& sheet, FractureLoad load,
                        const std::function<void(int)>& see) {
  return Run(study, sheet, load).run(see);
}

}  // namespace cuboct::learn
