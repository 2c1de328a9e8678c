// SPDX-License-Identifier: MIT
#include "emu/gpu/text_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "emu/gpu/rounds/host_code.h"
#include "emu/gpu/rounds/nvrtc.h"
#include "model/base/error.h"
#include "model/base/resources.h"
#include "model/real/real_engine.h"
#include "model/run/checkpoint.h"
#include "model/run/reference_engine.h"

namespace cuboct::gpu {
namespace {

RealOptions on_demand(size_t particles) {
  return {.threads = reference_threads(particles), .on_demand = true};
}

std::string compiled(const std::string& source, const std::string& architecture) {
  if (architecture == "host") return host_file(source, cache_directory());
  return compiled_file(source, architecture, cache_directory());
}

}  // namespace

std::unique_ptr<TextRun> TextRun::make(const Scene& scene, double cell_edge, const GpuChoice& choice,
                                       CheckpointReader* from) {
  const auto made = [&](const Body& body, const Memory& memory) {
    return std::unique_ptr<TextRun>(new TextRun(scene, body, cell_edge, choice, memory));
  };
  if (from == nullptr) return made(scene.body, {});
  const EngineMemory& kept = from->head().engine;
  if (kept.own.empty() || kept.counters[1] != static_cast<uint64_t>(choice.arithmetic)) refuse_another(*from);
  try {
    return made(cuboct::saved_body(*from, scene.rule, scene.body, Precision::float64),
                {from->head().step, kept.own});
  } catch (const DamagedMemory& error) {
    throw InputError(fmt::format("{} is damaged: {}", from->path(), error.what()));
  }
}

TextRun::TextRun(const Scene& scene, const Body& body, double cell_edge, const GpuChoice& choice,
                 const Memory& memory)
    : RoundsRun(scene, body, on_demand(body.size()), cell_edge, memory.step),
      choice_(choice),
      cell_edge_(cell_edge),
      device_(make_real_rounds(scene.rule, body_, scene.periodic, choice.arithmetic == Arithmetic::float64,
                               choice.engine, compiled, memory)) {
  renew();
  if (choice.hooks.ready) choice.hooks.ready();
}

void TextRun::advance(uint64_t steps, std::vector<uint64_t>*) {
  const auto done = [&] {
    if (choice_.hooks.did) choice_.hooks.did(device_->step_count() - step_);
    step_ = device_->step_count();
    stale_ = true;
  };
  try {
    device_->advance(steps);
  } catch (const LostPosition& error) {
    done();
    throw StepError({Fault::none, error.step, 0, error.particle, 0, error.what()});
  } catch (const TableEnds& error) {
    done();
    tell(error.what());
  }
  done();
}

void TextRun::tell(const std::string& why) {
  const auto stop = [&](const std::string& text) { return StepError({Fault::none, step_, 0, 0, 0, text}); };
  RealEngine& goes_ahead = reference();
  stale_ = true;
  try {
    goes_ahead.step(step_);
  } catch (const std::runtime_error& error) {
    throw stop(error.what());
  }
  throw stop(why);
}

void TextRun::renew() {
  device_->read(body_);
  for (const Vec3& v : body_.v) fastest_ = std::max(fastest_, v.cwiseAbs().maxCoeff());
  look_.reset();
}

void TextRun::follow(RealEngine& reference) {
  reference.place(body_, step_);
  reference.recall(device_->kept());
}

const RealLook& TextRun::look() {
  body();
  if (look_) return *look_;
  try {
    return look_.emplace(device_->look());
  } catch (const TableEnds& error) {
    throw RoundsError(error.what());
  }
}

std::vector<Vec3> TextRun::forces() {
  return scene_.rule.rounds->text()->still ? std::vector<Vec3>(body_.size(), Vec3::Zero()) : look().force;
}

std::vector<std::vector<double>> TextRun::fields() {
  std::vector<std::vector<double>> shown;
  for (const ProgramField& field : scene_.rule.rounds->text()->particle) {
    if (!field.shown) continue;
    const uint32_t numbers = field.numbers();
    std::vector<double>& values = shown.emplace_back(numbers * body_.size());
    for (size_t i = 0; i < body_.size(); ++i)
      for (uint32_t k = 0; k < numbers; ++k) values[numbers * i + k] = look().fields[field.first + k][i];
  }
  if (scene_.rule.rounds->text()->shows_damage) shown.push_back(damage());
  return shown;
}

double TextRun::largest_speed() {
  body();
  return fastest_ * scene_.rule.dt / cell_edge_;
}

cuboct::Counters TextRun::counters() {
  cuboct::Counters counters = device_->counters();
  notes_ = {{"precision", to_string(choice_.arithmetic)},
            {"integrator", "semi-implicit Euler"},
            {"rule", scene_.rule.rounds->declaration().name},
            {"kernels", device_->kernels()}};
  if (choice_.hooks.finish) choice_.hooks.finish(counters, notes_);
  return counters;
}

EngineMemory TextRun::memory() {
  return {{static_cast<uint64_t>(Precision::float64), static_cast<uint64_t>(choice_.arithmetic)},
          device_->memory()};
}

}  // namespace cuboct::gpu
