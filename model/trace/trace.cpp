// SPDX-License-Identifier: MIT
#include "model/trace/trace.h"

#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "model/base/enum_names.h"
#include "model/base/output.h"
#include "model/trace/hdf5_file.h"
#include "model/trace/trace_file.h"
#include "model/trace/trace_head.h"

namespace cuboct {
namespace {

using hdf5::Handle;
using hdf5::Reader;
using hdf5::Writer;

constexpr char kTraceFormat[] = "cuboct trace";
constexpr uint32_t kTraceVersion = 2;

// Of a group's datasets that grow frame by frame.
constexpr uint64_t kSlack = 1 << 16;  // bytes of the disk for a frame's share of indices and headers

// Rows per chunk: of 2^15 values, but no more than a frame has, so that frames reach the disk as they come.
hsize_t chunk_of(size_t particles, hsize_t columns) {
  return std::clamp<hsize_t>(particles, 1 << 10, (hsize_t{1} << 15) / columns);
}

// Numbers of which one comes with each frame: in place, so that a program that dies leaves them.
template <typename T>
class PerFrame {
 public:
  PerFrame(const Writer& out, hid_t where, const char* name, const char* unit, const char* what)
      : out_(out), name_(name), data_(out.growing<T>(where, name, {0}, {1 << 10}, false, unit, what)) {}
  void add(T value) {
    out_.write_block(data_, name_, {count_ + 1}, {count_}, {1}, &value);
    ++count_;
  }

 private:
  const Writer& out_;
  std::string name_;
  Handle data_;
  hsize_t count_ = 0;
};

constexpr const char* kOfRow = "[row]";

class FrameRows {
 public:
  // `head`: may be null.
  FrameRows(const Writer& out, size_t particles, const TraceHead* head)
      : out_(out),
        head_(head && head->si && head->rule ? head : nullptr),
        group_(out.group(out.root(), "frames")),
        step_(out, group_, "step", "step", "[frame]"),
        // Signed: NumPy makes a float of an unsigned 64-bit number plus 1.
        first_(out, group_, "first", "", "[frame]: rows first[k] to first[k+1]-1 are frame k"),
        id_(out, group_, "id", chunk_of(particles, 1), 1, "", kOfRow),
        type_(out, group_, "type", chunk_of(particles, 1), 1, "", "[row] index into `types`"),
        cell_(out, group_, "node", chunk_of(particles, 1), 1, "", "[row] index into lattice/cell"),
        x_(out, group_, "x", chunk_of(particles, 3), 3, "cell edge / 2^(P+G)",
           "[row][axis] offset in the node's cell"),
        v_(out, group_, "v", chunk_of(particles, 3), 3, "cell edge / step / 2^(P+G)",
           "[row][axis] velocity, half a step earlier"),
        u_(out, group_, "u", chunk_of(particles, 3), 3, "cell edge / 2^(P+G)",
           "[row][axis] displacement from the anchor") {
    first_.add(0);
    if (!head_) return;
    x_si_.emplace(out, group_, "x_si", chunk_of(particles, 3), 3, "m", "[row][axis] position");
    v_si_.emplace(out, group_, "v_si", chunk_of(particles, 3), 3, "m/s",
                  "[row][axis] velocity, half a step earlier");
  }

  void add(const State& frame) {
    const uint64_t bytes =
        frame.particles.size() * (2 * sizeof(uint32_t) + 1 + (head_ ? 15 : 9) * sizeof(int64_t));
    out_.reserve(bytes + bytes / 100 + pending() + kSlack);
    for (const Particle& p : frame.particles) {
      id_.add(&p.id);
      type_.add(&p.type);
      cell_.add(&p.cell);
      x_.add(p.x.data());
      v_.add(p.v.data());
      u_.add(p.u.data());
      if (!head_) continue;
      x_si_->add(position_of(*head_->rule, *head_->lattice, head_->origin, p).data());
      v_si_->add(velocity_of(*head_->rule, p).data());
    }
    rows_ += static_cast<int64_t>(frame.particles.size());
    step_.add(frame.step);
    first_.add(rows_);
    out_.flush();
  }
  // At most what finish() writes.
  uint64_t pending() const {
    return id_.chunk_bytes() + type_.chunk_bytes() + cell_.chunk_bytes() + (head_ ? 5 : 3) * x_.chunk_bytes();
  }
  void finish() {
    id_.finish(), type_.finish(), cell_.finish(), x_.finish(), v_.finish(), u_.finish();
    if (head_) x_si_->finish(), v_si_->finish();
  }

 private:
  const Writer& out_;
  const TraceHead* const head_;  // where positions are wanted in metres too
  Handle group_;
  PerFrame<uint64_t> step_;
  PerFrame<int64_t> first_;
  hdf5::Growing<uint32_t> id_;
  hdf5::Growing<uint8_t> type_;
  hdf5::Growing<uint32_t> cell_;
  hdf5::Growing<int64_t> x_, v_, u_;
  std::optional<hdf5::Growing<double>> x_si_, v_si_;
  int64_t rows_ = 0;
};

void write_bonds(const Writer& out, const Handle& group, const std::vector<uint64_t>& bonds) {
  out.array(group, "bonds", {bonds.size()}, bonds, "",
            "what the bonds of the last body keep: docs/reference/trace.md");
}

class BodyRows {
 public:
  BodyRows(const Writer& out, const RealFrame& first, const TraceHead* head)
      : out_(out),
        particles_(first.x.size()),
        group_(out.group(out.root(), "bodies")),
        step_(out, group_, "step", "step", "[frame]"),
        x_(out, group_, "x", chunk_of(particles_, 3), 3, "m", kRows),
        v_(out, group_, "v", chunk_of(particles_, 3), 3, "m/s", kRows) {
    if (head) out.array(group_, "type", {particles_}, head->scene.body.type, "", "[id] index into `types`");
    if (head && head->scene.deform) {
      scene_ = &head->scene;
      box_.emplace(out, group_, "box_extent", 1, 3, "m",
                   "[frame][axis] of the box that repeats; 0: an open axis");
    }
    if (!first.force.empty()) force_.emplace(out, group_, "force", chunk_of(particles_, 3), 3, "N", kRows);
    if (!first.u.empty()) u_.emplace(out, group_, "u", chunk_of(particles_, 3), 3, "m", kRows);
    for (const std::vector<double>& field : first.shown)
      numbers_.push_back(static_cast<uint32_t>(field.size() / std::max<size_t>(1, particles_)));
    if (numbers_.empty()) return;
    out.array(group_, "shown_numbers", {numbers_.size()}, numbers_, "",
              "[field] numbers of a particle in `shown`");
    const uint32_t all = std::accumulate(numbers_.begin(), numbers_.end(), 0u);
    shown_.emplace(out, group_, "shown", chunk_of(particles_, all), all, "",
                   "[row][number] what the rule shows, field after field, in SI; row frame * particles + id");
  }

  void add(const RealFrame& frame) {
    if (frame.x.size() != particles_ || frame.v.size() != particles_ ||
        frame.force.size() != (force_ ? particles_ : 0) || frame.u.size() != (u_ ? particles_ : 0))
      throw std::logic_error("the frames of a trace differ in their number of particles");
    const uint64_t numbers = std::accumulate(numbers_.begin(), numbers_.end(), uint64_t{12});
    const uint64_t bytes = particles_ * numbers * sizeof(double);
    out_.reserve(bytes + bytes / 100 + pending() + kSlack);
    for (size_t k = 0; k < particles_; ++k) {
      x_.add(frame.x[k].data());
      v_.add(frame.v[k].data());
      if (force_) force_->add(frame.force[k].data());
      if (u_) u_->add(frame.u[k].data());
    }
    if (shown_) add_shown(frame.shown);
    if (box_) box_->add(scene_->box_at(frame.step).extent.data());
    step_.add(frame.step);
    out_.flush();
  }
  uint64_t pending() const { return 4 * x_.chunk_bytes() + (shown_ ? shown_->chunk_bytes() : 0); }
  void finish(const std::optional<std::vector<uint64_t>>& bonds) {
    if (bonds) write_bonds(out_, group_, *bonds);
    x_.finish(), v_.finish();
    if (force_) force_->finish();
    if (u_) u_->finish();
    if (shown_) shown_->finish();
  }

 private:
  static constexpr const char* kRows = "[row][axis] row frame * particles + id";
  void add_shown(const std::vector<std::vector<double>>& shown) {
    bool same = shown.size() == numbers_.size();
    for (size_t f = 0; same && f < numbers_.size(); ++f) same = shown[f].size() == particles_ * numbers_[f];
    if (!same) throw std::logic_error("the frames of a trace differ in what their rule shows");
    std::vector<double> row;
    for (size_t k = 0; k < particles_; ++k) {
      row.clear();
      for (size_t f = 0; f < numbers_.size(); ++f)
        row.insert(row.end(), shown[f].begin() + static_cast<ptrdiff_t>(k * numbers_[f]),
                   shown[f].begin() + static_cast<ptrdiff_t>((k + 1) * numbers_[f]));
      shown_->add(row.data());
    }
  }
  const Writer& out_;
  size_t particles_;
  Handle group_;
  PerFrame<uint64_t> step_;
  hdf5::Growing<double> x_, v_;
  const Scene* scene_ = nullptr;  // where its box deforms
  std::optional<hdf5::Growing<double>> force_, u_, shown_, box_;
  std::vector<uint32_t> numbers_;  // by field that the rule shows
};

void read_frames(const Reader& in, const std::function<void(State)>& see) {
  const Handle group = in.group(in.root(), "frames");
  const auto step = in.array<uint64_t>(group, "step");
  const auto first = in.array<int64_t>(group, "first");
  in.same_length(
      first.size() == step.size() + 1 && first.front() == 0 && std::is_sorted(first.begin(), first.end()),
      "the frames' fields");
  for (const char* name : {"id", "type", "node", "x", "v", "u"})
    in.same_length(first.back() == static_cast<int64_t>(in.length(group, name)), "the frames' fields");
  for (size_t k = 0; k < step.size(); ++k) {
    const auto begin = static_cast<hsize_t>(first[k]), count = static_cast<hsize_t>(first[k + 1] - first[k]);
    State frame;
    frame.step = step[k];
    frame.particles.resize(count);
    const auto number = [&]<typename T>(const char* name, T Particle::*field) {
      in.rows<T>(group, name, begin, count, 1,
                 [&, row = size_t{0}](const T* value) mutable { frame.particles[row++].*field = *value; });
    };
    const auto triple = [&](const char* name, Int3 Particle::*field) {
      in.rows<int64_t>(group, name, begin, count, 3, [&, row = size_t{0}](const int64_t* values) mutable {
        std::copy_n(values, 3, (frame.particles[row++].*field).begin());
      });
    };
    number("id", &Particle::id);
    number("type", &Particle::type);
    number("node", &Particle::cell);
    triple("x", &Particle::x);
    triple("v", &Particle::v);
    triple("u", &Particle::u);
    see(std::move(frame));
  }
}

void read_bodies(const Reader& in, const std::function<void(RealFrame)>& see) {
  if (!in.has(in.root(), "bodies")) return;
  const Handle group = in.group(in.root(), "bodies");
  if (!in.has(group, "x") && in.has(group, "bonds")) return;  // the frames went elsewhere
  const auto step = in.array<uint64_t>(group, "step");
  const hsize_t rows = in.length(group, "x");
  in.same_length(!step.empty() && rows % step.size() == 0, "the bodies' fields");
  const bool forces = in.has(group, "force"), displaced = in.has(group, "u");
  in.same_length(in.length(group, "v") == rows && (!forces || in.length(group, "force") == rows) &&
                     (!displaced || in.length(group, "u") == rows),
                 "the bodies' fields");
  const size_t particles = rows / step.size();
  std::vector<uint32_t> numbers;
  if (in.has(group, "shown")) {
    numbers = in.array<uint32_t>(group, "shown_numbers");
    in.same_length(in.length(group, "shown") == rows, "the bodies' fields");
  }
  const auto all = static_cast<int>(std::accumulate(numbers.begin(), numbers.end(), 0u));
  for (size_t k = 0; k < step.size(); ++k) {
    RealFrame frame;
    frame.step = step[k];
    const auto triple = [&](const char* name, std::vector<Vec3> RealFrame::*field) {
      (frame.*field).resize(particles);
      in.rows<double>(group, name, k * particles, particles, 3,
                      [&, row = size_t{0}](const double* values) mutable {
                        std::copy_n(values, 3, (frame.*field)[row++].data());
                      });
    };
    triple("x", &RealFrame::x);
    triple("v", &RealFrame::v);
    if (forces) triple("force", &RealFrame::force);
    if (displaced) triple("u", &RealFrame::u);
    frame.shown.resize(numbers.size());
    if (all > 0)
      in.rows<double>(group, "shown", k * particles, particles, all, [&](const double* values) {
        for (size_t f = 0; f < numbers.size(); values += numbers[f++])
          frame.shown[f].insert(frame.shown[f].end(), values, values + numbers[f]);
      });
    see(std::move(frame));
  }
}

void write_findings(const Writer& out, const Trace& trace) {
  if (!trace.watched) return;
  const Handle group = out.group(out.root(), "findings");
  out.number<uint64_t>(group, "watched", *trace.watched);
  std::vector<uint8_t> failure;
  std::vector<uint64_t> step;
  std::vector<int64_t> particle;
  std::vector<double> place, number, limit;
  std::vector<std::string> text;
  for (const Finding& f : trace.findings) {
    failure.push_back(static_cast<uint8_t>(f.failure));
    step.push_back(f.step);
    particle.push_back(f.particle ? int64_t{*f.particle} : -1);
    place.insert(place.end(), f.place.data(), f.place.data() + 3);
    number.push_back(f.number);
    limit.push_back(f.limit);
    text.push_back(f.text);
  }
  const hsize_t count = text.size();
  out.array(group, "failure", {count}, failure, "", "[finding] model/trace/finding.h");
  out.array(group, "step", {count}, step, "step", "[finding]");
  out.array(group, "particle", {count}, particle, "", "[finding] id; -1 where there is none");
  out.array(group, "place", {count, 3}, place, "m", "[finding][axis]");
  out.array(group, "number", {count}, number, "", "[finding] in the unit of its text");
  out.array(group, "limit", {count}, limit, "", "[finding] in the unit of its text");
  out.names(group, "text", text);
}

void read_findings(const Reader& in, Trace& trace) {
  if (!in.has(in.root(), "findings")) return;
  const Handle group = in.group(in.root(), "findings");
  trace.watched = in.number<uint64_t>(group, "watched");
  const auto failure = in.array<uint8_t>(group, "failure");
  const auto step = in.array<uint64_t>(group, "step");
  const auto particle = in.array<int64_t>(group, "particle");
  const auto place = in.array<double>(group, "place", {3});
  const auto number = in.array<double>(group, "number"), limit = in.array<double>(group, "limit");
  const auto text = in.names(group, "text");
  for (const size_t size :
       {failure.size(), step.size(), particle.size(), place.size() / 3, number.size(), limit.size()})
    in.same_length(size == text.size(), "the findings' fields");
  for (size_t k = 0; k < text.size(); ++k) {
    if (failure[k] >= kFailures)
      throw InputError(in.missing("failure of number", std::to_string(failure[k])));
    Finding& f = trace.findings.emplace_back();
    f.failure = static_cast<Failure>(failure[k]);
    f.step = step[k];
    if (particle[k] >= 0) f.particle = static_cast<uint32_t>(particle[k]);
    f.place = Vec3(place[3 * k], place[3 * k + 1], place[3 * k + 2]);
    f.number = number[k];
    f.limit = limit[k];
    f.text = text[k];
  }
}

void write_curves(const Writer& out, const std::vector<Curve>& curves) {
  const Handle group = out.group(out.root(), "curves");
  uint32_t index = 0;
  for (const Curve& curve : curves) {
    if (curve.name.empty() || curve.name == "." || curve.name.find('/') != std::string::npos)
      throw InputError(fmt::format(
          "a curve cannot be called '{}' in a trace: a name needs characters, none of them '/'", curve.name));
    const Handle one = out.group(group, curve.name);
    out.number<uint32_t>(one, "index", index++);
    out.array(one, "step", {curve.step.size()}, curve.step, "step", "[sample]");
    out.array(one, "value", {curve.value.size()}, curve.value, curve.unit, "[sample]");
  }
}

std::vector<Curve> read_curves(const Reader& in) {
  const Handle group = in.group(in.root(), "curves");
  H5G_info_t info;
  if (H5Gget_info(group, &info) < 0) throw InputError(in.missing("group", "curves"));
  std::vector<std::pair<uint32_t, Curve>> found;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto name_at = [&](char* text, size_t size) {
      return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
    };
    Curve curve;
    curve.name.resize(std::max<ssize_t>(name_at(nullptr, 0), 0));
    name_at(curve.name.data(), curve.name.size() + 1);
    const Handle one = in.group(group, curve.name);
    curve.step = in.array<uint64_t>(one, "step");
    curve.value = in.array<double>(one, "value");
    const Handle value(H5Dopen2(one, "value", H5P_DEFAULT), H5Dclose, in.missing("dataset", "value"));
    curve.unit = in.text(value, "unit");
    in.same_length(curve.step.size() == curve.value.size(), "a curve's steps and values");
    found.emplace_back(in.number<uint32_t>(one, "index"), std::move(curve));
  }
  std::stable_sort(found.begin(), found.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<Curve> curves;
  for (auto& [index, curve] : found) curves.push_back(std::move(curve));
  return curves;
}

void write_cycles(const Writer& out, const Trace& trace) {
  if (trace.cycles.empty()) return;
  std::vector<uint64_t> flat;
  flat.reserve(2 * trace.cycles.size());
  for (const PhaseSpan& span : trace.cycles) flat.insert(flat.end(), {span.start, span.end});
  const hsize_t phases = trace.phases(), row = std::max<hsize_t>(trace.nodes, 1) * phases;
  std::string names;
  for (int p = 0; p < phases_of(trace.rounds); ++p) names += ' ' + phase_name(p, trace.rounds);
  if (trace.cycles.size() % row != 0)
    throw std::logic_error("a trace's cycles are not steps x nodes x phases");
  out.array(out.root(), "cycles", {trace.cycles.size() / row, row / phases, phases, 2}, flat, "cycle",
            "[step][node][phase][start, end]; phases:" + names);
}

}  // namespace

const char* to_string(Phase phase) {
  constexpr const char* kNames[] = {"exchange_x", "exchange_y", "exchange_z", "force",
                                    "update",     "migrate_x",  "migrate_y",  "migrate_z"};
  return name_in(kNames, phase);
}

std::string phase_name(int index, int rounds) {
  const auto [kind, round] = phase_at(index, rounds);
  const bool of_round = rounds > 1 && static_cast<int>(kind) < kRoundPhases;
  return of_round ? fmt::format("{} {}", to_string(kind), round + 1) : to_string(kind);
}

const char* Trace::ended() const {
  return !asked ? "" : stop ? "stopped" : steps() < *asked && !reached ? "interrupted" : "finished";
}

namespace {

uint64_t hash_in(const Reader& in) {
  const std::string text = in.text(in.root(), "plan_hash");
  uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (error != std::errc() || end != text.data() + text.size() || text.size() != 16)
    throw InputError(in.missing("hash of 16 hexadecimal digits", "plan_hash"));
  return hash;
}

// At most what all but frames takes of the disk.
uint64_t bytes_of(const Trace& trace) {
  uint64_t values = 2 * trace.state_hash.size() + 2 * trace.cycles.size(), texts = 0, parts = 16;
  for (const Curve& curve : trace.curves) {
    values += 2 * curve.value.size();
    parts += 2;
  }
  for (const auto& [name, value] : trace.counters)
    texts = std::max(texts, 2 * name.size() * trace.counters.size());
  for (const auto& [name, text] : trace.notes) texts += 2 * (name.size() + text.size()) * trace.notes.size();
  for (const Finding& finding : trace.findings) texts += (finding.text.size() + 64) * trace.findings.size();
  const uint64_t bytes = 8 * values + texts;
  return bytes + bytes / 100 + parts * (1 << 13) + kSlack;
}

// Whether the number of hashes is one that steps and hash_every allow.
bool hashes_fit(const Trace& trace) {
  if (trace.hash_every == 0) return false;
  if (trace.hash_every == 1 || trace.state_hash.empty()) return true;
  const uint64_t whole = trace.steps_done / trace.hash_every + 1;
  const bool rest = trace.steps_done % trace.hash_every != 0;
  return trace.state_hash.size() == whole + rest || (trace.stop && trace.state_hash.size() == whole);
}

}  // namespace

struct TraceWriter::Impl {
  Impl(const std::string& path, const std::string& temporary, bool packed, const TraceHead* head)
      : path(path), temporary(temporary), out(temporary, path, packed), head(head) {}

  std::string path, temporary;
  Writer out;
  const TraceHead* const head;
  std::optional<FrameRows> frames;
  std::optional<BodyRows> bodies;
};

TraceWriter::TraceWriter(const std::string& path, const std::string& temporary, bool packed,
                         const TraceHead* head)
    : impl_(std::make_unique<Impl>(path, temporary, packed, head)) {
  if (head) write_head(impl_->out, *head);
}

TraceWriter::~TraceWriter() {
  if (!impl_) return;
  const std::string temporary = impl_->temporary;
  impl_.reset();
  discard(temporary);
}

void TraceWriter::leave() { impl_.reset(); }

void TraceWriter::add(const State& frame) {
  if (!impl_->frames) impl_->frames.emplace(impl_->out, frame.particles.size(), impl_->head);
  impl_->frames->add(frame);
}

void TraceWriter::add(const RealFrame& frame) {
  if (!impl_->bodies) impl_->bodies.emplace(impl_->out, frame, impl_->head);
  impl_->bodies->add(frame);
}

void TraceWriter::finish(const Trace& trace) {
  if (!hashes_fit(trace)) throw std::logic_error("a trace's hashes do not fit its steps and hash_every");
  Writer& out = impl_->out;
  {
    out.reserve(bytes_of(trace) + (impl_->frames ? impl_->frames->pending() : 0) +
                (impl_->bodies ? impl_->bodies->pending() : 0));
    out.text(out.root(), "format", kTraceFormat);
    out.number<uint32_t>(out.root(), "version", kTraceVersion);
    out.text(out.root(), "engine", trace.engine);
    out.text(out.root(), "plan_hash", fmt::format("{:016x}", trace.plan_hash));
    out.number<uint64_t>(out.root(), "nodes", trace.nodes);
    if (trace.rounds > 1) out.number<int>(out.root(), "rounds", trace.rounds);
    out.number<double>(out.root(), "seconds", trace.seconds);
    out.number<uint64_t>(out.root(), "steps", trace.steps());
    out.number<uint64_t>(out.root(), "hash_every", trace.hash_every);
    if (trace.asked) {
      out.number<uint64_t>(out.root(), "steps_asked", *trace.asked);
      out.text(out.root(), "ended", trace.ended());
    }
    out.array(out.root(), "state_hash", {trace.state_hash.size()}, trace.state_hash, "",
              trace.hash_every == 1 ? "[step]" : "[step / hash_every], then of the last step");
    if (!impl_->frames) impl_->frames.emplace(out, 0, nullptr);
    impl_->frames->finish();
    impl_->frames.reset();
    if (impl_->bodies)
      impl_->bodies->finish(trace.bonds);
    else if (trace.bonds)  // the frames went elsewhere
      write_bonds(out, out.group(out.root(), "bodies"), *trace.bonds);
    impl_->bodies.reset();
    write_curves(out, trace.curves);
    write_cycles(out, trace);
    {
      const Handle counters = out.group(out.root(), "counters");
      std::vector<std::string> names;
      std::vector<double> values;
      for (const auto& [name, value] : trace.counters) names.push_back(name), values.push_back(value);
      out.names(counters, "name", names);
      out.array(counters, "value", {values.size()}, values, "", "[counter]");
    }
    if (!trace.notes.empty()) {
      const Handle notes = out.group(out.root(), "notes");
      std::vector<std::string> names, texts;
      for (const auto& [name, text] : trace.notes) names.push_back(name), texts.push_back(text);
      out.names(notes, "name", names);
      out.names(notes, "text", texts);
    }
    write_findings(out, trace);
    if (trace.reached) {
      const Handle reached = out.group(out.root(), "reached");
      out.text(reached, "curve", trace.reached->curve);
      out.text(reached, "side", trace.reached->side);
      out.number<uint64_t>(reached, "step", trace.reached->step);
      out.number<double>(reached, "value", trace.reached->value);
      out.number<double>(reached, "limit", trace.reached->limit);
    }
    if (trace.stop) {
      const Handle stop = out.group(out.root(), "stop");
      out.number<uint8_t>(stop, "fault", static_cast<uint8_t>(trace.stop->fault));
      out.text(stop, "fault_name", to_string(trace.stop->fault));
      out.number<uint64_t>(stop, "step", trace.stop->step);
      out.number<uint32_t>(stop, "node", trace.stop->cell);
      out.number<uint32_t>(stop, "particle", trace.stop->particle);
      out.number<int64_t>(stop, "number", trace.stop->number);
      out.text(stop, "text", trace.stop->text);
    }
    out.close();
  }
  rename_whole(impl_->temporary, impl_->path);
  impl_.reset();
}

void write_trace(const std::string& path, const Trace& trace, bool packed) {
  check_writable(path);
  TraceWriter out(path, temporary_beside(path), packed);
  for (const State& frame : trace.frames) out.add(frame);
  for (const RealFrame& frame : trace.bodies) out.add(frame);
  out.finish(trace);
}

namespace {

Trace read_rest(const Reader& in) {
  const std::string& path = in.path();
  if (in.text(in.root(), "format") != kTraceFormat) throw InputError(in.missing("attribute", "format"));
  const auto version = in.number<uint32_t>(in.root(), "version");
  if (version != kTraceVersion)
    throw InputError(fmt::format("{} is a trace of version {}; this program reads version {}", path, version,
                                 kTraceVersion));
  Trace trace;
  trace.engine = in.text(in.root(), "engine");
  trace.plan_hash = hash_in(in);
  trace.nodes = in.number<uint64_t>(in.root(), "nodes");
  trace.seconds = in.number<double>(in.root(), "seconds");
  trace.state_hash = in.array<uint64_t>(in.root(), "state_hash");
  trace.hash_every = in.number<uint64_t>(in.root(), "hash_every");
  const auto steps = in.number<uint64_t>(in.root(), "steps");
  if (trace.hash_every != 1 || trace.state_hash.empty()) trace.steps_done = steps;
  in.same_length(trace.hash_every > 0 && trace.steps() == steps, "steps and state hashes");
  if (in.has_attribute(in.root(), "steps_asked")) trace.asked = in.number<uint64_t>(in.root(), "steps_asked");
  trace.curves = read_curves(in);
  if (in.has(in.root(), "cycles")) {
    if (in.has_attribute(in.root(), "rounds")) trace.rounds = in.number<int>(in.root(), "rounds");
    in.same_length(trace.rounds >= 1 && trace.rounds <= kMostRounds, "rounds");
    const auto flat = in.array<uint64_t>(in.root(), "cycles", {trace.nodes, hsize_t{trace.phases()}, 2});
    for (size_t i = 0; i < flat.size(); i += 2) trace.cycles.push_back({flat[i], flat[i + 1]});
  }
  const Handle counters = in.group(in.root(), "counters");
  const auto names = in.names(counters, "name");
  const auto values = in.array<double>(counters, "value");
  in.same_length(names.size() == values.size(), "the counters' names and values");
  for (size_t i = 0; i < names.size(); ++i) trace.counters.emplace_back(names[i], values[i]);
  if (in.has(in.root(), "notes")) {
    const Handle notes = in.group(in.root(), "notes");
    const auto of = in.names(notes, "name"), texts = in.names(notes, "text");
    in.same_length(of.size() == texts.size(), "the notes' names and texts");
    for (size_t i = 0; i < of.size(); ++i) trace.notes.emplace_back(of[i], texts[i]);
  }
  read_findings(in, trace);
  if (in.has(in.root(), "bodies"))
    if (const Handle bodies = in.group(in.root(), "bodies"); in.has(bodies, "bonds"))
      trace.bonds = in.array<uint64_t>(bodies, "bonds");
  if (in.has(in.root(), "reached")) {
    const Handle reached = in.group(in.root(), "reached");
    trace.reached =
        Reached{in.text(reached, "curve"), in.text(reached, "side"), in.number<uint64_t>(reached, "step"),
                in.number<double>(reached, "value"), in.number<double>(reached, "limit")};
  }
  if (in.has(in.root(), "stop")) {
    const Handle stop = in.group(in.root(), "stop");
    trace.stop = StopReason{static_cast<Fault>(in.number<uint8_t>(stop, "fault")),
                            in.number<uint64_t>(stop, "step"),
                            in.number<uint32_t>(stop, "node"),
                            in.number<uint32_t>(stop, "particle"),
                            in.number<int64_t>(stop, "number"),
                            in.text(stop, "text")};
  }
  in.same_length(hashes_fit(trace), "steps and state hashes");
  return trace;
}

}  // namespace

struct TraceReader::Impl {
  explicit Impl(const std::string& path) : in(path), rest(read_rest(in)) {}
  Reader in;
  Trace rest;
};

TraceReader::TraceReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
TraceReader::~TraceReader() = default;
const Trace& TraceReader::rest() const { return impl_->rest; }
void TraceReader::frames(const std::function<void(State)>& see) const { read_frames(impl_->in, see); }
void TraceReader::bodies(const std::function<void(RealFrame)>& see) const { read_bodies(impl_->in, see); }

Trace read_trace(const std::string& path) {
  const TraceReader in(path);
  Trace trace = in.rest();
  in.frames([&](State frame) { trace.frames.push_back(std::move(frame)); });
  in.bodies([&](RealFrame frame) { trace.bodies.push_back(std::move(frame)); });
  return trace;
}

}  // namespace cuboct
