// SPDX-License-Identifier: MIT
#include "cli/view/difference.h"

#include <fmt/format.h>

#include <bit>

#include "model/base/error.h"
#include "model/base/json.h"
#include "model/trace/compare.h"
#include "model/trace/trace_head.h"

namespace cuboct {
namespace {

using First = RunDifference::First;

// Two's complement, or the bits of a double, in groups of four from the right.
std::string bits_of(uint64_t word, int count) {
  std::string text;
  for (int bit = count - 1; bit >= 0; --bit) {
    text += (word >> bit & 1) != 0 ? '1' : '0';
    if (bit > 0 && bit % 4 == 0) text += ' ';
  }
  return text;
}

std::string number_text(double value) { return fmt::format("{}", value); }

// Whether integers of both mean the same.
bool same_words(const Plan& a, const Plan& b) {
  const FixedRule &ra = a.rule, &rb = b.rule;
  return ra.widths.velocity_frac() == rb.widths.velocity_frac() && ra.cell_edge == rb.cell_edge &&
         ra.shape == rb.shape && ra.dt == rb.dt && a.origin == b.origin;
}

// One particle's numbers of one kind, of either run.
struct Side {
  const StoredRun& run;
  const Plan& plan = run.loaded().setup.plan;
  const bool real = run.real();

  Vec3 place(size_t frame, size_t i) const {
    if (real) return run.bodies(frame).x[i];
    return position_of(plan.rule, plan.lattice, plan.origin, state(frame).particles[i]);
  }
  Vec3 speed(size_t frame, size_t i) const {
    return real ? run.bodies(frame).v[i] : velocity_of(plan.rule, state(frame).particles[i]);
  }
  const State& state(size_t frame) const { return run.state(frame); }
  const Cell& cell(const Particle& particle) const { return plan.lattice.cell(particle.cell); }

  // Bits and decimal words of a component of the place or the velocity.
  void tell(size_t frame, size_t i, bool velocity, int axis, std::string& bits, std::string& words) const {
    if (real) {
      bits = bits_of(std::bit_cast<uint64_t>((velocity ? speed(frame, i) : place(frame, i))[axis]), 64);
      return;
    }
    const Particle& particle = state(frame).particles[i];
    const auto k = static_cast<size_t>(axis);
    const int64_t word = (velocity ? particle.v : particle.x)[k];
    bits = bits_of(static_cast<uint64_t>(word),
                   velocity ? plan.rule.widths.velocity_bits : plan.rule.widths.velocity_frac());
    words = velocity ? fmt::format("{}", word) : fmt::format("cell {}, {}", cell(particle)[k], word);
  }
};

class Comparison {
 public:
  Comparison(const StoredRun& a, const StoredRun& b)
      : a_{a}, b_{b}, bitwise_(!a_.real && !b_.real && same_words(a_.plan, b_.plan)) {}

  bool bitwise() const { return bitwise_; }
  std::string how() const {
    if (bitwise_) return "integers, bit by bit";
    if (a_.real && b_.real) return "doubles, bit by bit";
    return a_.real != b_.real ? "integers with doubles: values in SI"
                              : "integers of other formats: values in SI";
  }
  bool reduced() const { return a_.run.loaded().scene.boltzmann == 1; }

  // Whether a particle is the same in both; `first`: is told where it is not.
  bool equal(size_t frame, size_t i, First* first) const {
    return bitwise_ ? equal_words(frame, i, first) : equal_numbers(frame, i, first);
  }

 private:
  void tell(First& first, size_t frame, size_t i, bool velocity, int axis) const {
    first.field = fmt::format("{} {}", velocity ? "velocity" : "position", "xyz"[axis]);
    first.unit = reduced() ? "1" : velocity ? "m/s" : "m";
    first.si_a = number_text((velocity ? a_.speed(frame, i) : a_.place(frame, i))[axis]);
    first.si_b = number_text((velocity ? b_.speed(frame, i) : b_.place(frame, i))[axis]);
    a_.tell(frame, i, velocity, axis, first.bits_a, first.words_a);
    b_.tell(frame, i, velocity, axis, first.bits_b, first.words_b);
  }
  bool equal_numbers(size_t frame, size_t i, First* first) const {
    for (const bool velocity : {false, true}) {
      const Vec3 va = velocity ? a_.speed(frame, i) : a_.place(frame, i),
                 vb = velocity ? b_.speed(frame, i) : b_.place(frame, i);
      for (int axis = 0; axis < 3; ++axis)
        if (std::bit_cast<uint64_t>(va[axis]) != std::bit_cast<uint64_t>(vb[axis])) {
          if (first != nullptr) tell(*first, frame, i, velocity, axis);
          return false;
        }
    }
    return true;
  }
  bool equal_words(size_t frame, size_t i, First* first) const {
    const State &sa = a_.state(frame), &sb = b_.state(frame);
    const Particle &pa = sa.particles[i], &pb = sb.particles[i];
    const auto whole = [&](std::string field, int64_t word_a, int64_t word_b, int bits) {
      first->field = std::move(field);
      first->unit = "1";
      first->bits_a = bits_of(static_cast<uint64_t>(word_a), bits);
      first->bits_b = bits_of(static_cast<uint64_t>(word_b), bits);
      first->words_a = fmt::format("{}", word_a), first->words_b = fmt::format("{}", word_b);
      return false;
    };
    if (pa.type != pb.type) return first != nullptr && whole("type", pa.type, pb.type, 8);
    const Cell &ca = a_.cell(pa), &cb = b_.cell(pb);
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      if (ca[k] == cb[k] && pa.x[k] == pb.x[k]) continue;
      if (first != nullptr) tell(*first, frame, i, false, axis);
      return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      if (pa.v[k] == pb.v[k]) continue;
      if (first != nullptr) tell(*first, frame, i, true, axis);
      return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      if (pa.u[k] == pb.u[k]) continue;
      if (first == nullptr) return false;
      const double unit = position_units(a_.plan.rule)[axis];
      whole(fmt::format("displacement {}", "xyz"[axis]), pa.u[k], pb.u[k],
            a_.plan.rule.widths.displacement_bits);
      first->unit = reduced() ? "1" : "m";
      first->si_a = number_text(static_cast<double>(pa.u[k]) * unit);
      first->si_b = number_text(static_cast<double>(pb.u[k]) * unit);
      return false;
    }
    const size_t count = sa.particles.size(), numbers = sa.fields.size() / count;
    if (sb.fields.size() != sa.fields.size()) return true;  // another rule keeps other numbers
    for (size_t f = 0; f < numbers; ++f)
      if (const int64_t fa = sa.fields[i * numbers + f], fb = sb.fields[i * numbers + f]; fa != fb)
        return first != nullptr && whole(fmt::format("number {} of the rule's fields", f), fa, fb, 64);
    return true;
  }

  const Side a_, b_;
  const bool bitwise_;
};

// What both traces recorded besides frames.
std::string besides_of(const Trace& a, const Trace& b, const Lattice& lattice) {
  const auto text = [&](const std::optional<Mismatch>& mismatch) {
    return mismatch ? mismatch->text("A", "B", lattice) : "";
  };
  if (a.plan_hash == b.plan_hash) return text(compare(a, b));
  // Of two machines, whose cycles are others: what holds of the states alone.
  const auto states_of = [](const Trace& trace) {
    Trace states;
    states.state_hash = trace.state_hash, states.hash_every = trace.hash_every;
    states.steps_done = trace.steps_done, states.stop = trace.stop;
    return states;
  };
  return text(compare(states_of(a), states_of(b)));
}

}  // namespace

std::string RunDifference::json() const {
  std::string found = "null";
  if (first)
    found = json_object({{"frame", std::to_string(first->frame)},
                         {"step", std::to_string(first->step)},
                         {"particle", std::to_string(first->particle)},
                         {"field", cuboct::json(first->field)},
                         {"unit", cuboct::json(first->unit)},
                         {"si", cuboct::json(std::vector<std::string>{first->si_a, first->si_b})},
                         {"bits", cuboct::json(std::vector<std::string>{first->bits_a, first->bits_b})},
                         {"words", cuboct::json(std::vector<std::string>{first->words_a, first->words_b})}});
  return json_object({{"how", cuboct::json(how)},
                      {"first", found},
                      {"particles", cuboct::json(particles)},
                      {"besides", cuboct::json(besides)},
                      {"hashes", std::to_string(hashes)}});
}

void check_comparable(const StoredRun& a, const StoredRun& b) {
  const Scene &sa = a.loaded().scene, &sb = b.loaded().scene;
  const auto refuse = [&](const std::string& why) {
    throw InputError(
        fmt::format("{} and {} are runs of different bodies: {}", a.directory(), b.directory(), why),
        "--with takes a run of the same particles, in another engine or on another machine");
  };
  if (a.particles() != b.particles())
    refuse(fmt::format("{} and {} particles", a.particles(), b.particles()));
  if (packing_hash(sa) != packing_hash(sb)) refuse("their particles are packed at other places");
  const char* unit = sa.boltzmann == 1 ? "" : " s";
  if (sa.rule.dt != sb.rule.dt)
    throw InputError(fmt::format("the time step of {} is {}{}, and that of {} {}{}", a.directory(),
                                 sa.rule.dt, unit, b.directory(), sb.rule.dt, unit),
                     "dt in [run] of the scene; runs of one time step have frames at the same times");
}

RunDifference difference_of(const StoredRun& a, const StoredRun& b) {
  const Comparison comparison(a, b);
  RunDifference difference;
  difference.how = comparison.how();
  for (size_t k = 0; k < a.frames(); ++k) {
    size_t count = 0;
    for (size_t i = 0; i < a.particles(); ++i) {
      First first;
      if (comparison.equal(k, i, difference.first ? nullptr : &first)) continue;
      ++count;
      if (difference.first) continue;
      first.frame = k, first.step = a.step(k), first.particle = static_cast<uint32_t>(i);
      difference.first = first;
    }
    difference.particles.push_back(count);
  }
  if (comparison.bitwise()) {
    difference.besides = besides_of(a.trace(), b.trace(), a.loaded().setup.plan.lattice);
    difference.hashes = states_compared(a.trace(), b.trace());
  }
  return difference;
}

}  // namespace cuboct
