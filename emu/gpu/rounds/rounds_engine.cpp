// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_engine.h"

#include <algorithm>

#include "emu/gpu/rounds/rounds_domain.h"
#include "emu/gpu/rounds/rounds_text.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/program/integer_program.h"

namespace cuboct::gpu {
namespace {

constexpr uint32_t kShortestBatch = 4;
constexpr uint32_t kProvenByGolden = 32768;  // particles: more take golden too long

size_t index(int n) { return static_cast<size_t>(n); }

// Whether some pair's graph reads it of a partner.
bool read_of_others(const graph::FixedProgram& program, graph::Source source, int place) {
  for (const graph::Round& round : program.rounds)
    for (const graph::Node& node : round.pair.nodes)
      if (node.op == graph::Op::input && node.source == source &&
          (source != graph::Source::other_field || program.place(node.index) + node.axis == place))
        return true;
  return false;
}

class RoundsEngine final : public IntegerEngine {
 public:
  RoundsEngine(const Plan& plan, const State& initial, const Options& options, const CompileRounds& compile)
      : plan_(plan),
        program_(plan.program->program),
        block_(options.block),
        domain_(plan, initial, options),
        count_(static_cast<uint32_t>(initial.particles.size())),
        step_(initial.step),
        numbers_(program_.numbers()) {
    for (int f = 0; f < numbers_; ++f)
      seen_.push_back(read_of_others(program_, graph::Source::other_field, f));
    seen_v_ = read_of_others(program_, graph::Source::other_v, 0);
    if (compile) load(compile);
    if (!has_kernels_) return;
    make_lists();
    prove();
  }

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    const uint64_t end = step_ + steps;
    while (step_ < end && !interrupted()) {
      get_ready();
      const auto batch = static_cast<uint32_t>(std::min<uint64_t>(end - step_, batch_));
      const uint32_t done = run(batch, hashes, proven_);
      step_ += done;
      age_ += done;
      if (done == told_.old || (done < batch && age_ > 0)) {
        listed_ = false;  // of a doubt, too: cells have counted particles that left them since
        // The next one may live a little longer.
        batch_ =
            static_cast<uint32_t>(std::clamp<uint64_t>(age_ + age_ / 4 + 1, kShortestBatch, kLongestBatch));
      } else if (done < batch) {
        step_by_golden();
        if (hashes != nullptr) hashes->push_back(hash());
      } else if (batch == batch_) {
        batch_ = std::min(2 * batch_, kLongestBatch);
      }
    }
  }
  uint64_t step_count() const override { return step_; }

  State state() const override { return domain_.state(step_); }
  uint64_t hash() const override { return hash_of(plan_.lattice, state()); }
  std::vector<Int3> next_velocities() override {
    // A list that has served may leave a doubt that a new one does not.
    for (bool fresh = false; !fresh;) {
      get_ready();
      fresh = age_ == 0;
      const RoundsPlaces here = domain_.places;
      const bool done = run(1, nullptr, proven_) == 1;
      std::vector<Int3> v;
      if (done) v = domain_.velocities();
      domain_.places = here, near_stale_ = true;
      if (done) return v;
      listed_ = false;  // cells have counted particles of a step that was doubted
    }
    return GoldenIntegers(program_, plan_.lattice, plan_.arch.capacity, state(), plan_.program->rows)
        .next_velocities();
  }
  // Golden's slots are not kept: by id.
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    for (const Particle& particle : state().particles) see(particle);
  }
  cuboct::Counters counters() const override {
    return {{"list_builds", static_cast<double>(builds_)},
            {"golden_steps", static_cast<double>(golden_steps_)},
            {"longest_list", static_cast<double>(domain_.longest_list)},
            {"listed_pairs", domain_.listed_pairs},
            {"halo_particles", static_cast<double>(ghosts_of(domain_.slabs))},
            {"device_bytes", static_cast<double>(domain_.bytes)}};
  }
  Notes notes() const override { return {{"kernels", how_}}; }

 private:
  // What the devices told of a batch.
  struct Told {
    uint32_t doubt = kNoStep, old = kNoStep;
  };

  void get_ready() {
    if (!listed_) make_lists();
    if (!has_kernels_ || proven_) return;
    prove();
    if (!listed_) make_lists();
  }
  void make_lists() {
    domain_.make_lists(age_);
    near_stale_ = true;
    ++builds_;
    age_ = 0;
    listed_ = true;
  }

  void load(const CompileRounds& compile) {
    const RoundsText text = text_of(program_, sizeof(RoundsFrame));
    try {
      for (auto& slab : domain_.slabs) {
        const std::string architecture = architecture_of(slab->stream);
        slab->kernels =
            std::make_unique<LoadedKernels>(slab->stream, compile(text.source, architecture), text.names);
        slab->table_entries.set(slab->stream, text.entries);
        how_ = "compiled for " + architecture;
      }
      has_kernels_ = true;
    } catch (const std::runtime_error& e) {
      how_ = std::string("interpreted: ") + e.what();
    }
  }
  // One step of the state at hand, taken from there both ways, and by golden too where that is soon done.
  // Where it is none for the interpreter, the next batch may have one that is.
  void prove() {
    const RoundsPlaces here = domain_.places;
    const bool stale = near_stale_;
    const auto hash_of_step = [&](bool compiled) {
      std::vector<uint64_t> hashes;
      run(1, &hashes, compiled);
      domain_.places = here, near_stale_ = stale;
      return hashes;
    };
    const std::vector<uint64_t> expected = hash_of_step(false);
    if (expected.empty()) {
      listed_ = false;  // as of a look at the next step
      return;
    }
    proven_ = hash_of_step(true) == expected;
    if (proven_ && count_ <= kProvenByGolden) {
      GoldenIntegers golden(program_, plan_.lattice, plan_.arch.capacity, state(), plan_.program->rows);
      golden.advance(1, nullptr);
      proven_ = golden.hash() == expected.front();
    }
    if (proven_) return;
    has_kernels_ = false;
    how_ = "interpreted: compiled ones take step " + std::to_string(step_ + 1) + " otherwise";
  }

  uint32_t run(uint32_t steps, std::vector<uint64_t>* hashes, bool compiled) {
    for (auto& slab : domain_.slabs) {
      slab->compiled = compiled;
      for_each(slab->stream, 0, 1, 32, RoundsReset{slab->control.data(), near_stale_});
      if (hashes != nullptr) slab->hashes.zero(slab->stream);
      slab->stream.record(slab->done);
    }
    std::vector<RoundsPlaces> after{domain_.places};
    for (uint32_t n = 1; n <= steps; ++n) {
      step(n);
      after.push_back(domain_.places);
      if (hashes != nullptr)
        for (auto& slab : domain_.slabs) add_hashes(*slab, n);
    }
    wait_for_all(domain_.slabs);
    told_ = {};
    std::vector<RoundsControl> controls;
    for (auto& slab : domain_.slabs) {
      controls.push_back(slab->control.host(slab->stream, 0, 1)[0]);
      told_.doubt = std::min(told_.doubt, controls.back().doubt);
      told_.old = std::min(told_.old, controls.back().old);
    }
    uint32_t done = steps;
    if (told_.doubt <= steps) done = told_.doubt - 1;
    done = std::min(done, told_.old);
    domain_.places = after[done];
    // A step that was begun in vain may have left some particles a new near list.
    near_stale_ = done < steps;
    for (const RoundsControl& control : controls)
      near_stale_ = near_stale_ || control.near_stale[done + 1] != 0;
    if (hashes != nullptr) {
      std::vector<uint64_t> sums(done);
      for (auto& slab : domain_.slabs) {
        const std::vector<uint64_t> part = slab->hashes.host(slab->stream, 1, done);
        for (uint32_t k = 0; k < done; ++k) sums[k] += part[k];
      }
      hashes->insert(hashes->end(), sums.begin(), sums.end());
    }
    return done;
  }
  void add_hashes(RoundsSlab& slab, uint32_t number) {
    const RoundsCells& cells = slab.cells;
    const RoundsHash hash{slab.view(domain_.places),
                          {cells.period[0], cells.period[1], cells.period[2]},
                          program_.position_frac + program_.guard,
                          numbers_,
                          domain_.bonds(slab),
                          slab.counts.data(),
                          slab.own,
                          number,
                          slab.control.data()};
    sum_each(slab.stream, 0, slab.own, block_, hash, slab.hashes.data() + number);
  }

  // What a round makes of each particle and each bond.
  struct Made {
    std::vector<bool> fields, bonds;
  };
  Made made_by(const graph::Round& round) const {
    Made made{std::vector<bool>(index(numbers_)), std::vector<bool>(index(program_.bond_numbers()))};
    for (const graph::Write& write : round.writes)
      made.fields[index(program_.place(write.field) + write.component)] = true;
    for (const graph::Write& write : round.bond_writes)
      made.bonds[index(program_.bond_place(write.field) + write.component)] = true;
    return made;
  }

  void step(uint32_t number) {
    const size_t rounds = program_.rounds.size();
    for (size_t k = 0; k < rounds; ++k) {
      const Made made = made_by(program_.rounds[k]);
      const bool last = k + 1 == rounds;
      begin_round(domain_.slabs, k == 0);
      for (auto& slab : domain_.slabs) {
        slab->launch(frame(*slab, made, k, number), k, block_);
        push(*slab, made, last, number);
        slab->stream.record(slab->done);
      }
      for (size_t f = 0; f < made.fields.size(); ++f)
        if (made.fields[f]) domain_.places.fields[f] = 1 - domain_.places.fields[f];
      for (size_t n = 0; n < made.bonds.size(); ++n)
        if (made.bonds[n]) domain_.places.bonds[n] = 1 - domain_.places.bonds[n];
    }
    domain_.places.at = 1 - domain_.places.at;
  }
  RoundsFrame frame(RoundsSlab& slab, const Made& made, size_t round, uint32_t number) {
    RoundsFrame frame{};
    frame.from = slab.view(domain_.places), frame.to = slab.view(domain_.places, 1 - domain_.places.at);
    frame.list = slab.list, frame.near = slab.near, frame.cells = slab.cells,
    frame.bonds = domain_.bonds(slab);
    frame.entries = slab.table_entries.data();
    frame.type_constants = slab.code.type_constants(), frame.pair_constants = slab.code.pair_constants();
    frame.guard = program_.guard, frame.frac = program_.position_frac + program_.guard;
    frame.first = round == 0, frame.last = round + 1 == program_.rounds.size();
    frame.step = step_ + number - 1, frame.number = number, frame.control = slab.control.data();
    frame.others = slab.others.data(), frame.other_count = static_cast<int>(domain_.slabs.size()) - 1;
    // What a round writes it makes in the other copy, as others may still read this one.
    for (size_t f = 0; f < made.fields.size(); ++f)
      if (made.fields[f]) frame.to.fields[f] = slab.copies[1 - domain_.places.fields[f]].fields[f].data();
    for (size_t n = 0; n < made.bonds.size(); ++n)
      if (made.bonds[n]) frame.bonds.to[n] = slab.bond_copies[1 - domain_.places.bonds[n]][n].data();
    return frame;
  }
  // What the round made and pairs read of partners goes to the ghosts.
  void push(RoundsSlab& slab, const Made& made, bool last, uint32_t number) {
    for (const RoundsSending& sending : slab.sendings) {
      RoundsSlab& other = *domain_.slabs[sending.to];
      RoundsPush push{};
      push.sent = slab.sent.data() + sending.first, push.first = sending.at;
      push.number = number, push.control = slab.control.data();
      const auto add = [&](const Array<int64_t>& from, const Array<int64_t>& to) {
        push.from[push.columns] = from.data(), push.to[push.columns++] = to.data();
      };
      for (size_t f = 0; f < made.fields.size(); ++f) {
        const size_t to = 1 - domain_.places.fields[f];
        if (made.fields[f] && seen_[f]) add(slab.copies[to].fields[f], other.copies[to].fields[f]);
      }
      const RoundsSlab::Copy& from = slab.copies[1 - domain_.places.at];
      const RoundsSlab::Copy& to = other.copies[1 - domain_.places.at];
      for (size_t a = 0; last && a < 3; ++a) {
        if (program_.bonded) add(from.x[a], to.x[a]);
        if (seen_v_) add(from.v[a], to.v[a]);
      }
      if (last && !program_.bonded) push.place_from = from.place.data(), push.place_to = to.place.data();
      if (push.columns > 0 || push.place_from != nullptr)
        for_each(slab.stream, 0, sending.count, block_, push);
    }
  }

  // Throws where the step cannot be done.
  void step_by_golden() {
    const State before = state();
    GoldenIntegers golden(program_, plan_.lattice, plan_.arch.capacity, before, plan_.program->rows);
    golden.advance(1, nullptr);
    ++golden_steps_;
    ++step_;
    domain_.upload(golden.state());
    listed_ = false;
  }

  const Plan& plan_;
  const graph::FixedProgram& program_;
  int block_;
  RoundsDomain domain_;
  uint32_t count_;
  uint64_t step_;
  int numbers_;
  std::vector<bool> seen_;  // by number: pairs read it of partners
  bool seen_v_ = false;
  bool has_kernels_ = false, proven_ = false;
  std::string how_ = "interpreted";
  uint32_t batch_ = kLongestBatch;
  Told told_;
  bool listed_ = false, near_stale_ = true;
  uint64_t age_ = 0;  // steps that the list has served
  uint64_t builds_ = 0, golden_steps_ = 0;
};

}  // namespace

std::unique_ptr<IntegerEngine> make_rounds_engine(const Plan& plan, const State& initial,
                                                  const Options& options, const CompileRounds& compile) {
  return std::make_unique<RoundsEngine>(plan, initial, options, compile);
}

}  // namespace cuboct::gpu
