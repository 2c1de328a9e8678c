// SPDX-License-Identifier: MIT
// The fixed rule: golden's bits. A step that may not be possible is golden's own, on the host, so that errors
// are too.
#include <cmath>
#include <limits>

#include "emu/gpu/fixed/fixed_policy.h"
#include "emu/gpu/machine.h"
#include "hw/arch/cell_box.h"
#include "model/base/interrupt.h"
#include "model/contract/golden.h"
#include "model/contract/quantise.h"

namespace cuboct::gpu {
namespace {

template <typename Number>
class FixedEngine final : public Engine {
 public:
  using Policy = FixedPolicy<Number>;

  FixedEngine(const Scene& scene, const Plan& plan, const State& initial, const Options& options)
      : plan_(plan), step_(initial.step) {
    machine_ = std::make_unique<Machine<Policy>>(
        options, setup_of(scene, plan), EnergyTables(with_masses_of(plan.rule, scene.rule)), host(initial),
        [&](Stream& stream) { return std::make_unique<FixedRuleOnDevice>(stream, plan.rule); });
  }

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    const uint64_t last = step_ + steps;
    while (step_ < last && !interrupted()) {
      if (old_) renew();
      const auto outcome = machine_->run(last - step_, hashes);
      step_ += outcome.done;
      using End = typename Machine<Policy>::End;
      // Occupancy counters include particles that did not enter: new lists rebuild them.
      old_ = outcome.end != End::full && outcome.end != End::near_list;
      if (outcome.end != End::doubt && (outcome.end != End::crowded || machine_->age() > 0)) continue;
      step_by_golden();
      if (hashes) hashes->push_back(machine_->hash());
    }
  }
  uint64_t step_count() const override { return step_; }

  Reading read(bool energies) override {
    if (old_) renew();
    Reading reading;
    reading.step = step_;
    const FixedRule& rule = plan_.rule;
    const double position = std::ldexp(rule.cell_edge, -rule.widths.velocity_frac());
    for (const Found<Policy>& found : machine_->read_probed()) {
      Vec3 x;
      for (int a = 0; a < 3; ++a)
        x[a] = plan_.origin[a] + found.cell.c[a] * rule.cell_edge +
               static_cast<double>(Policy::whole(rule.widths, found.x, found.residue, a)) * position;
      reading.x.push_back(x);
      reading.force.push_back(force_of(rule, {found.kick.at[0], found.kick.at[1], found.kick.at[2]}));
      reading.v.push_back(velocity_units(rule).cwiseProduct(Vec3(found.v[0], found.v[1], found.v[2])));
    }
    if (energies) {
      const Sums sums = machine_->read_energies();
      const double velocity = std::ldexp(rule.cell_edge / rule.dt, -rule.widths.velocity_frac());
      reading.energies = energies_of(sums, velocity);
      reading.virial = sums.virial;
      reading.largest_speed = sums.speed * velocity;
    }
    return reading;
  }
  void probe(const std::vector<uint32_t>& ids) override { machine_->probe(ids); }

  State state() override {
    const HostParticles<Policy> host = machine_->download();
    State state{step_, std::vector<Particle>(host.size())};
    const Widths& widths = plan_.rule.widths;
    const Lattice& lattice = plan_.lattice;
    for (size_t i = 0; i < host.size(); ++i) {
      Particle& p = state.particles[host.id[i]];
      p.id = host.id[i];
      p.type = static_cast<uint8_t>(type_in(host.x[i].last));
      Cell cell;
      for (int a = 0; a < 3; ++a) {
        cell[a] = host.cell[i].c[a] + (host.x[i].at[a] >> widths.position_frac);
        if (const int period = lattice.period()[a]; period > 0) cell[a] = modulo(cell[a], period);
        p.x[a] = Policy::whole(widths, host.x[i], host.residue[i], a) &
                 ((int64_t{1} << widths.velocity_frac()) - 1);
        p.v[a] = host.v[i].at[a];
        if (!host.u.empty()) p.u[a] = host.u[i].at[a];
      }
      p.cell = lattice.find(cell);
    }
    return state;
  }
  uint64_t hash() override { return machine_->hash(); }
  Body body() override { return to_real(state(), plan_.rule, plan_.lattice, plan_.origin); }

  const Counters& counters() const override {
    counters_ = machine_->counters;
    counters_.golden_steps = golden_steps_;
    return counters_;
  }

 private:
  static typename Machine<Policy>::Setup setup_of(const Scene& scene, const Plan& plan) {
    const FixedRule& rule = plan.rule;
    typename Machine<Policy>::Setup setup;
    Geometry& g = setup.geometry;
    const CellBox box = box_of(plan.lattice, true);
    g.low = box.low;
    for (int a = 0; a < 3; ++a) {
      g.wraps[a] = plan.lattice.period()[a] > 0;
      g.total[a] = static_cast<int>(box.extent(a));
    }
    g.lattice = &plan.lattice;
    // Two cells' edges hold any cutoff, which is an edge at most, and the skin.
    g.reach = Policy::kReach;
    setup.radius = std::sqrt(std::ldexp(static_cast<double>(rule.cutoff2), -2 * rule.widths.difference_frac));
    // Half a unit of a difference along three axes, for both of a pair; and floats of a cell's coordinates,
    // below 2 edges, which lists and displacements since then are made of.
    setup.rounding = 2 * std::ldexp(1.0, -rule.widths.difference_frac) +
                     16 * static_cast<double>(std::numeric_limits<float>::epsilon());
    setup.largest_skin = 0.2 * setup.radius;
    setup.capacity = static_cast<uint32_t>(plan.arch.capacity);
    setup.pd = rule.pd, setup.damped = rule.damped;
    setup.residue_bits = rule.widths.guard;
    const double cutoff = scene.rule.cutoff();
    for (int a = 0; a < 3; ++a) {
      setup.edge[a] = rule.cell_edge / cutoff;
      setup.origin[a] = plan.origin[a] / cutoff;
    }
    setup.unit = std::ldexp(rule.cell_edge / cutoff, -rule.widths.velocity_frac());
    return setup;
  }

  HostParticles<Policy> host(const State& state) const {
    HostParticles<Policy> host;
    const size_t n = state.particles.size();
    host.x.resize(n), host.v.resize(n), host.residue.resize(n), host.cell.resize(n), host.id.resize(n);
    const int guard = plan_.rule.widths.guard;
    if (plan_.rule.pd) host.u.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const Particle& p = state.particles[i];
      const Cell& cell = plan_.lattice.cell(p.cell);
      for (int a = 0; a < 3; ++a) {
        host.x[i].at[a] = static_cast<int32_t>(p.x[a] >> guard);
        host.residue[i].at[a] = static_cast<uint32_t>(p.x[a] & ((int64_t{1} << guard) - 1));
        host.v[i].at[a] = static_cast<Number>(p.v[a]);
        host.cell[i].c[a] = cell[a];
        if (plan_.rule.pd) host.u[i].at[a] = p.u[a];
      }
      host.x[i].last = p.type;
      host.id[i] = p.id;
    }
    return host;
  }

  void renew() {
    machine_->make_lists();
    old_ = false;
  }

  // Throws where the step cannot be done.
  void step_by_golden() {
    Golden golden(plan_.rule, plan_.lattice, plan_.arch.capacity, state());
    golden.step();
    ++golden_steps_;
    ++step_;
    machine_->upload(host(golden.state()));
    old_ = false;
  }

  const Plan& plan_;
  std::unique_ptr<Machine<Policy>> machine_;
  uint64_t step_;
  uint64_t golden_steps_ = 0;
  bool old_ = false;  // the lists no longer serve
  mutable Counters counters_;
};

}  // namespace

std::unique_ptr<Engine> make_fixed_engine(const Scene& scene, const Plan& plan, const State& initial,
                                          const Options& options) {
  require_widths(plan.rule.widths);
  if (plan.rule.widths.velocity_bits <= 32)
    return std::make_unique<FixedEngine<int32_t>>(scene, plan, initial, options);
  return std::make_unique<FixedEngine<int64_t>>(scene, plan, initial, options);
}

}  // namespace cuboct::gpu
