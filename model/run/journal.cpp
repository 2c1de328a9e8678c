// SPDX-License-Identifier: MIT
#include "model/run/journal.h"

#include <fmt/format.h>

#include "model/base/error.h"

namespace cuboct {
namespace {

constexpr uint64_t kJournalMagic = 0x4c4e524a54424355;  // "UCBTJRNL"
constexpr uint64_t kJournalVersion = 3;
enum Kind : uint64_t { kHash = 1, kSample, kCycles, kFrame, kRealFrame };

}  // namespace

void put(WordWriter& out, const Particle& p, bool displaced) {
  out.word(p.id | uint64_t{p.cell} << 32);
  for (size_t a = 0; a < 3; ++a)  // a position has at most 50 bits
    out.word(static_cast<uint64_t>(p.x[a]) | (a == 2 ? uint64_t{p.type} << 56 : 0));
  for (const int64_t v : p.v) out.word(static_cast<uint64_t>(v));
  if (displaced)
    for (const int64_t u : p.u) out.word(static_cast<uint64_t>(u));
}

Particle take_particle(WordReader& in, bool displaced) {
  Particle p;
  const uint64_t place = in.word();
  p.id = static_cast<uint32_t>(place);
  p.cell = static_cast<uint32_t>(place >> 32);
  for (int64_t& x : p.x) x = static_cast<int64_t>(in.word());
  p.type = static_cast<uint8_t>(static_cast<uint64_t>(p.x[2]) >> 56);
  p.x[2] &= (int64_t{1} << 56) - 1;
  for (int64_t& v : p.v) v = static_cast<int64_t>(in.word());
  if (displaced)
    for (int64_t& u : p.u) u = static_cast<int64_t>(in.word());
  return p;
}

void put(WordWriter& out, const std::vector<Vec3>& x, const std::vector<Vec3>& v,
         const std::vector<Vec3>& u) {
  for (size_t id = 0; id < x.size(); ++id)
    for (const std::vector<Vec3>* of : {&x, &v, &u})
      if (!of->empty())
        for (const double c : (*of)[id]) out.number(c);
}

void take_body(WordReader& in, size_t particles, bool displaced, Body& body) {
  in.expect(particles, displaced ? 9 : 6);
  body.x.resize(particles), body.v.resize(particles), body.u.resize(displaced ? particles : 0);
  for (size_t id = 0; id < particles; ++id)
    for (std::vector<Vec3>* of : {&body.x, &body.v, &body.u})
      if (!of->empty())
        for (double& c : (*of)[id]) c = in.number();
}

Journal::Journal(const std::string& path, uint64_t plan_hash, bool displaced)
    : path_(path), displaced_(displaced), out_(std::make_unique<WordWriter>(path, WordMark{})) {
  for (const uint64_t value : {kJournalMagic, kJournalVersion, plan_hash}) out_->word(value);
}

Journal::Journal(const std::string& path, uint64_t plan_hash, bool displaced, const WordMark& end,
                 Trace& trace)
    : path_(path), displaced_(displaced) {
  WordReader in(path);
  if (in.size() < end.words)
    throw InputError(
        fmt::format("{} is damaged: its checkpoint needs {} words, it has {}", path, end.words, in.size()));
  for (uint64_t k = 0; k < end.words; ++k) in.word();
  if (in.mark() != end)
    throw InputError(fmt::format("{} is damaged: its words hash to {:016x}, its checkpoint says {:016x}",
                                 path, in.mark().hash, end.hash));
  in.seek(0);
  if (in.word() != kJournalMagic || in.word() != kJournalVersion || in.word() != plan_hash)
    throw InputError(fmt::format("{} is not the journal of this plan", path));
  while (in.mark().words < end.words) {
    const uint64_t place = in.mark().words, kind = in.word(), step = in.word(), words = in.count(1);
    switch (kind) {
      case kHash:
        trace.state_hash.push_back(in.word());
        break;
      case kSample:
        // The first has all curves.
        if (trace.curves.empty()) trace.curves.resize(words);
        if (words > trace.curves.size())
          throw InputError(fmt::format("{} is damaged: a sample has more curves than the first", path));
        for (size_t k = 0; k < words; ++k) {
          trace.curves[k].step.push_back(step);
          trace.curves[k].value.push_back(in.number());
        }
        break;
      case kCycles:
        for (uint64_t k = 0; k < words / 2; ++k) {
          const uint64_t start = in.word();
          trace.cycles.push_back({start, in.word()});
        }
        break;
      case kFrame:
      case kRealFrame:
        frame_steps_.push_back(step);
        frame_places_.push_back(place);
        in.seek(place + 3 + words);
        break;
      default:
        throw InputError(fmt::format("{} is not the journal of this plan", path));
    }
  }
  out_ = std::make_unique<WordWriter>(path, end);
}

void Journal::head(uint64_t kind, uint64_t step, uint64_t words) {
  for (const uint64_t value : {kind, step, words}) out_->word(value);
}

void Journal::hash(uint64_t step, uint64_t hash) {
  head(kHash, step, 1);
  out_->word(hash);
}

void Journal::sample(uint64_t step, std::span<const double> values) {
  head(kSample, step, values.size());
  for (const double value : values) out_->number(value);
}

void Journal::cycles(uint64_t step, std::span<const PhaseSpan> spans) {
  head(kCycles, step, 2 * spans.size());
  for (const PhaseSpan& span : spans) {
    out_->word(span.start);
    out_->word(span.end);
  }
}

void Journal::frame(const RunState& state) {
  const auto begin = [&](uint64_t kind, uint64_t step, uint64_t words) {
    frame_steps_.push_back(step);
    frame_places_.push_back(out_->mark().words);
    head(kind, step, words);
  };
  if (const State* fixed = std::get_if<State>(&state)) {
    begin(kFrame, fixed->step, fixed->particles.size() * (displaced_ ? 10 : 7));
    for (const Particle& p : fixed->particles) put(*out_, p, displaced_);
    return;
  }
  const RealFrame& real = std::get<RealFrame>(state);
  size_t words = 1 + real.x.size() * (displaced_ ? 9 : 6);
  for (const std::vector<double>& field : real.shown) words += 1 + field.size();
  begin(kRealFrame, real.step, words);
  out_->word(real.x.size());
  put(*out_, real.x, real.v, real.u);
  for (const std::vector<double>& field : real.shown) {
    out_->word(field.size());
    for (const double number : field) out_->number(number);
  }
}

WordMark Journal::sync() {
  out_->sync();
  return out_->mark();
}

void Journal::for_each_frame(const std::function<void(RunState)>& see) {
  sync();
  WordReader in(path_);
  for (size_t k = 0; k < frame_steps_.size(); ++k) {
    in.seek(frame_places_[k]);
    const bool real = in.word() == kRealFrame;
    in.seek(frame_places_[k] + 2);
    const uint64_t words = in.count(1);
    if (real) {
      const uint64_t end = in.mark().words + words;
      Body body;
      take_body(in, in.count(displaced_ ? 9 : 6), displaced_, body);
      RealFrame frame{frame_steps_[k], std::move(body.x), std::move(body.v), {}, std::move(body.u)};
      while (in.mark().words < end)
        for (double& number : frame.shown.emplace_back(in.count(1))) number = in.number();
      see(std::move(frame));
      continue;
    }
    State frame;
    frame.step = frame_steps_[k];
    frame.particles.resize(words / (displaced_ ? 10 : 7));
    for (Particle& p : frame.particles) p = take_particle(in, displaced_);
    see(std::move(frame));
  }
}

}  // namespace cuboct
