// SPDX-License-Identifier: MIT
#include "model/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "model/hdf5_file.h"
#include "model/measure.h"
#include "model/output.h"
#include "model/trace_head.h"

namespace cuboct {
namespace {

using hdf5::Handle;
using hdf5::Reader;
using hdf5::Writer;

constexpr char kFormat[] = "cuboct trace";
constexpr uint32_t kVersion = 2;

// The particles of all frames, one after another.
template <typename States>
class Rows {
 public:
  explicit Rows(States& frames) : frames_(frames) {}
  auto& next() {
    while (at_ == frames_[frame_].particles.size()) ++frame_, at_ = 0;
    return frames_[frame_].particles[at_++];
  }

 private:
  States& frames_;
  size_t frame_ = 0, at_ = 0;
};

void write_frames(const Writer& out, const std::vector<State>& frames, const TraceHead* head) {
  std::vector<uint64_t> step;
  std::vector<int64_t> first{0};  // signed: NumPy makes a float of an unsigned 64-bit number plus 1
  for (const State& frame : frames) {
    step.push_back(frame.step);
    first.push_back(first.back() + static_cast<int64_t>(frame.particles.size()));
  }
  const Handle group = out.group(out.root(), "frames");
  out.array(group, "step", {step.size()}, step, "step", "[frame]");
  out.array(group, "first", {first.size()}, first, "", "[frame]: rows first[k] to first[k+1]-1 are frame k");
  const auto count = static_cast<hsize_t>(first.back());
  const auto number = [&]<typename T>(const char* name, T Particle::*field, const char* what) {
    out.rows<T>(group, name, count, 1, "", what,
                [rows = Rows(frames), field](T* value) mutable { *value = rows.next().*field; });
  };
  const auto triple = [&](const char* name, Int3 Particle::*field, const char* unit, const char* what) {
    out.rows<int64_t>(group, name, count, 3, unit, what,
                      [rows = Rows(frames), field](int64_t* values) mutable {
                        const Int3& from = rows.next().*field;
                        std::copy(from.begin(), from.end(), values);
                      });
  };
  number("id", &Particle::id, "[row]");
  number("type", &Particle::type, "[row] index into `types`");
  number("node", &Particle::node, "[row] index into lattice/cell");
  triple("x", &Particle::x, "cell edge / 2^(P+G)", "[row][axis] offset in the node's cell");
  triple("v", &Particle::v, "cell edge / step / 2^(P+G)", "[row][axis] velocity, half a step earlier");
  triple("u", &Particle::u, "cell edge / 2^(P+G)", "[row][axis] displacement from the anchor");
  if (!head || !head->si) return;
  const auto real = [&](const char* name, const char* unit, const char* what, auto value) {
    out.rows<double>(group, name, count, 3, unit, what, [&, rows = Rows(frames)](double* values) mutable {
      const Vec3 one = value(rows.next());
      std::copy_n(one.data(), 3, values);
    });
  };
  const FixedRule& rule = *head->rule;
  real("x_si", "m", "[row][axis] position",
       [&](const Particle& p) { return position_of(rule, *head->lattice, head->origin, p); });
  real("v_si", "m/s", "[row][axis] velocity, half a step earlier",
       [&](const Particle& p) { return velocity_of(rule, p); });
}

std::vector<State> read_frames(const Reader& in) {
  const Handle group = in.group(in.root(), "frames");
  const auto step = in.array<uint64_t>(group, "step");
  const auto first = in.array<int64_t>(group, "first");
  const hsize_t count = in.length(group, "id");
  in.same_length(first.size() == step.size() + 1 && first.front() == 0 &&
                     first.back() == static_cast<int64_t>(count) &&
                     std::is_sorted(first.begin(), first.end()),
                 "the frames' fields");
  for (const char* field : {"type", "node", "x", "v", "u"})
    in.same_length(in.length(group, field) == count, "the frames' fields");
  std::vector<State> frames(step.size());
  for (size_t k = 0; k < frames.size(); ++k) {
    frames[k].step = step[k];
    frames[k].particles.resize(static_cast<size_t>(first[k + 1] - first[k]));
  }
  const auto number = [&]<typename T>(const char* name, T Particle::*field) {
    in.rows<T>(group, name, count, 1,
               [rows = Rows(frames), field](const T* value) mutable { rows.next().*field = *value; });
  };
  const auto triple = [&](const char* name, Int3 Particle::*field) {
    in.rows<int64_t>(group, name, count, 3, [rows = Rows(frames), field](const int64_t* values) mutable {
      std::copy_n(values, 3, (rows.next().*field).begin());
    });
  };
  number("id", &Particle::id);
  number("type", &Particle::type);
  number("node", &Particle::node);
  triple("x", &Particle::x);
  triple("v", &Particle::v);
  triple("u", &Particle::u);
  return frames;
}

void write_bodies(const Writer& out, const std::vector<RealFrame>& frames, const TraceHead* head) {
  if (frames.empty()) return;
  const Handle group = out.group(out.root(), "bodies");
  const size_t particles = frames.front().x.size();
  std::vector<uint64_t> step;
  for (const RealFrame& frame : frames) step.push_back(frame.step);
  out.array(group, "step", {step.size()}, step, "step", "[frame]");
  const auto triple = [&](const char* name, std::vector<Vec3> RealFrame::*field, const char* unit) {
    for (const RealFrame& frame : frames)
      if ((frame.*field).size() != particles)
        throw std::logic_error("the frames of a trace differ in their number of particles");
    out.rows<double>(group, name, frames.size() * particles, 3, unit,
                     "[row][axis] row frame * particles + id",
                     [&frames, particles, field, row = size_t{0}](double* values) mutable {
                       const Vec3& from = (frames[row / particles].*field)[row % particles];
                       std::copy_n(from.data(), 3, values);
                       ++row;
                     });
  };
  triple("x", &RealFrame::x, "m");
  triple("v", &RealFrame::v, "m/s");
  if (!frames.front().force.empty()) triple("force", &RealFrame::force, "N");
  if (head) out.array(group, "type", {particles}, head->scene.body.type, "", "[id] index into `types`");
}

std::vector<RealFrame> read_bodies(const Reader& in) {
  if (!in.has(in.root(), "bodies")) return {};
  const Handle group = in.group(in.root(), "bodies");
  const auto step = in.array<uint64_t>(group, "step");
  const hsize_t rows = in.length(group, "x");
  in.same_length(!step.empty() && rows % step.size() == 0, "the bodies' fields");
  const size_t particles = rows / step.size();
  std::vector<RealFrame> frames(step.size());
  for (size_t k = 0; k < frames.size(); ++k) frames[k].step = step[k];
  const auto triple = [&](const char* name, std::vector<Vec3> RealFrame::*field) {
    for (RealFrame& frame : frames) (frame.*field).resize(particles);
    in.rows<double>(group, name, rows, 3,
                    [&frames, particles, field, row = size_t{0}](const double* values) mutable {
                      std::copy_n(values, 3, (frames[row / particles].*field)[row % particles].data());
                      ++row;
                    });
  };
  triple("x", &RealFrame::x);
  triple("v", &RealFrame::v);
  if (in.has(group, "force")) triple("force", &RealFrame::force);
  return frames;
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
  out.array(group, "failure", {count}, failure, "", "[finding] model/finding.h");
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
  for (const size_t size : {failure.size(), step.size(), particle.size(), place.size() / 3, number.size(),
                            limit.size()})
    in.same_length(size == text.size(), "the findings' fields");
  for (size_t k = 0; k < text.size(); ++k) {
    if (failure[k] >= kFailures) throw InputError(in.missing("failure of number", std::to_string(failure[k])));
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
  const hsize_t row = std::max<hsize_t>(trace.nodes, 1) * kPhases;
  if (trace.cycles.size() % row != 0)
    throw std::logic_error("a trace's cycles are not steps x nodes x phases");
  out.array(
      out.root(), "cycles", {trace.cycles.size() / row, row / kPhases, hsize_t{kPhases}, 2}, flat, "cycle",
      "[step][node][phase][start, end]; phases: exchange_x exchange_y exchange_z force update migrate_x "
      "migrate_y migrate_z");
}

}  // namespace

const char* to_string(Phase phase) {
  switch (phase) {
    case Phase::exchange_x:
      return "exchange_x";
    case Phase::exchange_y:
      return "exchange_y";
    case Phase::exchange_z:
      return "exchange_z";
    case Phase::force:
      return "force";
    case Phase::update:
      return "update";
    case Phase::migrate_x:
      return "migrate_x";
    case Phase::migrate_y:
      return "migrate_y";
    case Phase::migrate_z:
      return "migrate_z";
  }
  return "?";
}

const char* Trace::ended() const {
  return !asked ? "" : stop ? "stopped" : steps() < *asked ? "interrupted" : "finished";
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

// Whether the number of hashes is one that steps and hash_every allow.
bool hashes_fit(const Trace& trace) {
  if (trace.hash_every == 0) return false;
  if (trace.hash_every == 1 || trace.state_hash.empty()) return true;
  const uint64_t whole = trace.steps_done / trace.hash_every + 1;
  const bool rest = trace.steps_done % trace.hash_every != 0;
  return trace.state_hash.size() == whole + rest || (trace.stop && trace.state_hash.size() == whole);
}

}  // namespace

void write_trace(const std::string& path, const Trace& trace, bool packed, const TraceHead* head) {
  if (!hashes_fit(trace)) throw std::logic_error("a trace's hashes do not fit its steps and hash_every");
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are ours to tell
  check_writable(path);
  write_whole(path, [&](const std::string& temporary) {
    Writer out(temporary, path, packed);
    out.text(out.root(), "format", kFormat);
    out.number<uint32_t>(out.root(), "version", kVersion);
    out.text(out.root(), "engine", trace.engine);
    out.text(out.root(), "plan_hash", fmt::format("{:016x}", trace.plan_hash));
    out.number<uint64_t>(out.root(), "nodes", trace.nodes);
    out.number<double>(out.root(), "seconds", trace.seconds);
    out.number<uint64_t>(out.root(), "steps", trace.steps());
    out.number<uint64_t>(out.root(), "hash_every", trace.hash_every);
    if (trace.asked) {
      out.number<uint64_t>(out.root(), "steps_asked", *trace.asked);
      out.text(out.root(), "ended", trace.ended());
    }
    if (head) write_head(out, *head, !trace.frames.empty() || !trace.cycles.empty());
    out.array(out.root(), "state_hash", {trace.state_hash.size()}, trace.state_hash, "",
              trace.hash_every == 1 ? "[step]" : "[step / hash_every], then of the last step");
    write_frames(out, trace.frames, head);
    write_bodies(out, trace.bodies, head);
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
    if (trace.stop) {
      const Handle stop = out.group(out.root(), "stop");
      out.number<uint8_t>(stop, "fault", static_cast<uint8_t>(trace.stop->fault));
      out.text(stop, "fault_name", to_string(trace.stop->fault));
      out.number<uint64_t>(stop, "step", trace.stop->step);
      out.number<uint32_t>(stop, "node", trace.stop->node);
      out.number<uint32_t>(stop, "particle", trace.stop->particle);
      out.number<int64_t>(stop, "number", trace.stop->number);
      out.text(stop, "text", trace.stop->text);
    }
    out.close();
  });
}

Trace read_trace(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Reader in(path);
  if (in.text(in.root(), "format") != kFormat) throw InputError(in.missing("attribute", "format"));
  const auto version = in.number<uint32_t>(in.root(), "version");
  if (version != kVersion)
    throw InputError(
        fmt::format("{} is a trace of version {}; this program reads version {}", path, version, kVersion));
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
  trace.frames = read_frames(in);
  trace.bodies = read_bodies(in);
  trace.curves = read_curves(in);
  if (in.has(in.root(), "cycles")) {
    const auto flat = in.array<uint64_t>(in.root(), "cycles", {trace.nodes, hsize_t{kPhases}, 2});
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

}  // namespace cuboct
