// SPDX-License-Identifier: MIT
#include "study/learn/cracks.h"

#include <fmt/format.h>

#include <cmath>

#include "model/base/error.h"
#include "study/learn/crack_data.h"
#include "study/sweep/thread_time.h"
#include "study/sweep/work.h"

namespace cuboct::learn {
namespace {

class Stage {
 public:
  Stage(const LearnStudy& study, const Learned& learned, const Cracks& cracks)
      : study_(study), learned_(learned), cracks_(cracks) {}

  CrackModel learn(const KernelFit& learned, uint64_t draw, bool pairs) const {
    CrackModel model{learned.kernel, learned.validation, {}, {}};
    if (pairs || study_.stretch.positive) {
      const KernelFit fit = fit_kernel(learned_.grid, learned_.training, learned_.validation, study_.kernel,
                                       {.horizon = study_.stretch.horizon,
                                        .degree = pairs ? 0 : study_.stretch.degree,
                                        .draw = draw,
                                        .positive = true,
                                        .like = pairs ? nullptr : &learned.kernel,
                                        .pairs = pairs});
      model.kernel = fit.kernel, model.validation = fit.validation;
    }
    model.stretch =
        fit_stretch(data(0, 0), model.kernel, slit(), interval(), study_.stretch, study_.prediction);
    for (size_t t = 0; t < kCrackTests.size(); ++t) model.tests[t] = errors(model, t);
    return model;
  }

  std::vector<CrackState> seen_by(const CrackModel& model, size_t load, size_t grid) const {
    return seen(data(load, grid), model.kernel, breaking(model, grid), slit());
  }
  std::vector<CrackState> predicted_by(const CrackModel& model, size_t load, size_t grid) const {
    return predict(data(load, grid), model.kernel, breaking(model, grid), slit(), interval(),
                   study_.prediction);
  }
  CostPoint cost(const std::string& name, const CrackModel& model, size_t load, size_t grid) const {
    const double begin = study::thread_seconds();
    const std::vector<CrackState> predicted = predicted_by(model, load, grid);
    const double seconds = study::thread_seconds() - begin;
    return {name, cracks_.grids[grid].points, FractureLoad{static_cast<uint8_t>(load)},
            errors_of(predicted, seen_by(model, load, grid), free(grid)), seconds};
  }

 private:
  double slit() const { return study_.fracture.slit * kAngstrom; }
  double interval() const { return study_.fracture.interval * kPicosecond; }
  CrackData data(size_t load, size_t grid) const {
    const FractureSample& sample = cracks_.samples[load];
    return {cracks_.grids[grid], sample.density[grid], sample.velocity[grid], sample.frames[grid]};
  }
  std::vector<size_t> free(size_t grid) const {
    return inside(cracks_.grids[grid], study_.prediction.collar);
  }
  // One energy of a crack at any spacing: s0 goes as 1/sqrt(horizon) (section 5.4).
  Breaking breaking(const CrackModel& model, size_t grid) const {
    const double coarser = cracks_.grids[0].step() / cracks_.grids[grid].step();
    return {model.stretch.stretch * std::sqrt(coarser), study_.stretch.width};
  }
  CrackErrors errors(const CrackModel& model, size_t test) const {
    const size_t load = load_of_test(test), grid = grid_of_test(test);
    return errors_of(predicted_by(model, load, grid), seen_by(model, load, grid), free(grid));
  }

  const LearnStudy& study_;
  const Learned& learned_;
  const Cracks& cracks_;
};

}  // namespace

void check_cracks(const LearnStudy& study) {
  const AtomCell sheet = resting_sheet(study.sheet);
  const double edge = sheet.box.edges(1, 1);
  if (study.fracture.slit > edge - study.sheet.bond)
    throw placed(study,
                 InputError(fmt::format("a slit of {:g} angstrom parts the sheet, whose edge is {:.3g} "
                                        "angstrom",
                                        study.fracture.slit, edge),
                            "a shorter 'slit', or more cells")
                     .about({"fracture.slit", "fracture"}));
  for (const Grid& grid : fracture_grids(study, sheet)) WaveOperator(grid, study.stretch.horizon);
}

Cracks learn_cracks(const LearnStudy& study, const Learned& learned, const std::string& directory, int jobs) {
  Cracks out;
  out.grids = fracture_grids(study, resting_sheet(study.sheet));
  out.samples = cracked_sheets(study, directory, jobs);
  const Stage stage(study, learned, out);
  const KernelFit& best = learned.tried[learned.best].fit;
  out.drawn.resize(learned.drawn.size());
  std::vector<study::Piece> pieces;
  pieces.push_back({1, [&] { out.model = stage.learn(best, 0, false); }});
  pieces.push_back({1, [&] { out.pairs = stage.learn(best, 0, true); }});
  for (size_t k = 0; k < out.drawn.size(); ++k)
    pieces.push_back(
        {1, [&, k] { out.drawn[k] = stage.learn(learned.drawn[k], study.kernel.seed + k, false); }});
  study::work_off(std::move(pieces), jobs, "critical stretches", true);
  for (size_t t = 0; t < kCrackTests.size(); ++t) {
    out.seen[t] = stage.seen_by(out.model, load_of_test(t), grid_of_test(t));
    out.predicted[t] = stage.predicted_by(out.model, load_of_test(t), grid_of_test(t));
  }
  for (const size_t load : {0, 1}) {
    out.cost.push_back({"atoms", 0, FractureLoad{static_cast<uint8_t>(load)}, {}, out.samples[load].seconds});
    for (const size_t grid : {2, 0, 1}) out.cost.push_back(stage.cost("solid", out.model, load, grid));
    for (const size_t grid : {2, 0, 1}) out.cost.push_back(stage.cost("pairs", out.pairs, load, grid));
  }
  return out;
}

}  // namespace cuboct::learn
