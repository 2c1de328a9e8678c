// SPDX-License-Identifier: MIT
#include "model/rules/tersoff_rule.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "model/base/error.h"

namespace cuboct {
namespace {

constexpr double kSkin = 0.15;  // of the cutoff: no second shell of diamond or graphene comes into the list

RuleDeclaration declared() {
  RuleDeclaration rule;
  rule.name = "tersoff";
  rule.bonds = BondRange::current;
  rule.particle = {{"partial", 3, "N", "G_ij = dE_i/d(x_j - x_i) of each neighbour j", true},
                   {"own", 3, "N", "sum of the particle's own partial forces"},
                   {kForceField, 3, "N", "sum over neighbours of G_ij - G_ji"}};
  rule.rounds = {{"order",
                  {"position"},
                  {{"zeta", 1, "1", "what the other bonds take from this one", true},
                   {"slope", 3, "N", "by the particle's energy", true},
                   {"push", 3, "N", "of all bonds"}},
                  {},
                  {"partial", "own"}},
                 {"collect", {"partial"}, {{"pull", 3, "N", "of the neighbours' G_ji"}}, {}, {kForceField}}};
  check(rule);
  return rule;
}

// Along axes that do not repeat an edge is a direction alone.
AtomBox box_of(const Periodic& periodic, double cutoff) {
  AtomBox box;
  box.edges.setZero();
  for (int a = 0; a < 3; ++a) {
    box.periodic[static_cast<size_t>(a)] = periodic.extent[a] > 0;
    box.edges(a, a) = periodic.extent[a] > 0 ? periodic.extent[a] : cutoff;
  }
  return box;
}

class TersoffRounds final : public RoundsTerms {
 public:
  TersoffRounds(const Tersoff& tersoff, const Body& body, const Periodic& periodic, int threads)
      : threads_(threads),
        box_(box_of(periodic, tersoff.cutoff())),
        list_(tersoff.cutoff(), kSkin * tersoff.cutoff(), bond_lanes()),
        forces_(tersoff),
        f_(body.x.size(), Vec3::Zero()) {}

  void set_box(const Periodic& periodic) override {
    for (int a = 0; a < 3; ++a)
      if (periodic.extent[a] > 0) box_.edges(a, a) = periodic.extent[a];
  }
  void begin(const std::vector<Vec3>& x) override {
    list_.update(box_, x);
    forces_.begin(list_, box_, x, {.threads = threads_});
    summed_ = false;
  }
  // An engine's parts are whole groups of lanes, but for the last.
  void pair(size_t round, size_t begin, size_t end, bool) override {
    const size_t lanes = list_.lanes(), first = begin / lanes, last = (end + lanes - 1) / lanes;
    if (begin % lanes != 0 || (end % lanes != 0 && end != f_.size()))
      throw std::logic_error(fmt::format("rows {} to {} are no whole groups of {}", begin, end, lanes));
    round == 0 ? forces_.first_sweep(first, last) : forces_.second_sweep(first, last, f_);
  }
  void finish(size_t, size_t, size_t) override {}
  const std::vector<Vec3>& force() const override { return f_; }

  double energy() const override { return summed().energy(); }
  Mat3 stress(size_t particle, double volume) const override { return summed().virial_of(particle) / volume; }
  uint64_t bonds() const override { return forces_.bonds(); }

 private:
  const TersoffForces& summed() const {
    if (!summed_) forces_.sum_up(threads_);
    summed_ = true;
    return forces_;
  }

  int threads_;
  AtomBox box_;
  BondList list_;
  mutable TersoffForces forces_;
  std::vector<Vec3> f_;
  mutable bool summed_ = false;
};

class TersoffRule final : public RoundsRule {
 public:
  TersoffRule(std::string name, const Tersoff& tersoff, const CrystalRest& rest)
      : name_(std::move(name)),
        published_(tersoff),
        tersoff_(tersoff.scaled(kElectronVolt, kAngstrom)),
        stiffness_(rest.curvature * kElectronVolt / (kAngstrom * kAngstrom)),
        wave_(rest.wave * kElectronVolt) {}

  const RuleDeclaration& declaration() const override {
    static const RuleDeclaration rule = declared();
    return rule;
  }
  std::string element() const override { return tersoff_.elements.front(); }
  bool lets_box_deform() const override { return true; }
  double bond_reach() const override { return tersoff_.cutoff(); }
  double stable_time_step(double mass, double) const override {
    return stiffness_ > 0 ? 2 / std::sqrt(stiffness_ / mass) : 0;
  }
  double stiffness() const override { return stiffness_; }
  double sound_speed(double mass) const override { return std::sqrt(wave_ / mass); }
  std::vector<DeclarationLine> settings() const override {
    const TersoffTerm<double>& t = published_.terms[0];
    const auto set = [](const char* name, std::string text, const char* note) {
      return DeclarationLine{name, std::move(text), note};
    };
    return {{"potential", name_, published_.elements[0]},
            set("A, lambda1", fmt::format("{} eV, {} /angstrom", t.A, t.lambda1), "repulsion"),
            set("B, lambda2", fmt::format("{} eV, {} /angstrom", t.B, t.lambda2), "attraction"),
            set("n, beta", fmt::format("{}, {}", t.n, t.beta), "what other bonds take from one"),
            set("c, d, cos_theta0", fmt::format("{}, {}, {}", t.c, t.d, t.cos_theta0), "angles"),
            set("m, gamma, lambda3", fmt::format("{}, {}, {} /angstrom", t.m, t.gamma, t.lambda3),
                "angles and lengths"),
            set("R, D", fmt::format("{} angstrom, {} angstrom", t.R, t.D),
                "the potential falls from R - D to R + D")};
  }
  std::unique_ptr<RoundsTerms> bind(const Rule&, const Body& body, const Periodic& periodic,
                                    int threads) const override {
    auto terms = std::make_unique<TersoffRounds>(tersoff_, body, periodic, threads);
    try {
      terms->begin(body.x);
    } catch (const std::runtime_error& error) {
      throw InputError(error.what());
    }
    return terms;
  }

 private:
  std::string name_;
  Tersoff published_, tersoff_;  // in eV and angstrom, in J and m
  double stiffness_, wave_;      // N/m, J
};

}  // namespace

std::shared_ptr<const RoundsRule> tersoff_rule(const std::string& name, const Tersoff& tersoff,
                                               const CrystalRest& rest) {
  if (tersoff.elements.size() != 1) throw InputError("the rule 'tersoff' is of one element");
  return std::make_shared<TersoffRule>(name, tersoff, rest);
}

}  // namespace cuboct
