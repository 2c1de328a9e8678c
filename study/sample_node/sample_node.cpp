// SPDX-License-Identifier: MIT
#include "study/sample_node/sample_node.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <optional>

#include "model/atoms/bond_order/bond_list.h"
#include "model/base/error.h"

namespace cuboct {
namespace {

using Number = DatapathNumber;
using NodeSample = DatapathSample<Number>;
using Forces = DatapathForces<Number>;

constexpr double kShake = 0.02;    // angstrom, of atoms whose forces are compared
constexpr double kRests = 32;      // quanta of force: less moves an atom by less than a quantum
constexpr uint32_t kMost = 300;    // evaluations
constexpr double kNearest = 0.85;  // of the bond at rest: the tables begin there
constexpr double kLeastZeta = 0.25, kMostZeta = 3;  // of the zeta at rest
constexpr double kLongestStretch = 0.3;             // of the bond at rest: a difference of two

// Where the tables have to reach.
struct Ranges {
  double nearest = 0, cutoff = 0, zeta = 0;  // angstrom, angstrom, 1
};

// With beta in gamma, so that zeta is of the order of 1.
TersoffTerm<double> scaled(TersoffTerm<double> term) {
  term.gamma *= term.beta, term.beta = 1;
  return term;
}

class NodeTables {
 public:
  NodeTables(const TersoffTerm<double>& term, const Ranges& range, uint64_t most)
      : exact_(term), stretched(exact_.stretched) {
    using Bond = DatapathBond<double>;
    for (double Bond::*field : {&Bond::inverse_r, &Bond::cut, &Bond::cut_slope, &Bond::push,
                                &Bond::push_slope, &Bond::pull, &Bond::pull_slope})
      bond_.emplace_back(range.nearest * range.nearest, range.cutoff * range.cutoff, most, [&](double r2) {
        Bond at;
        exact_.bond(r2, at);
        return at.*field;
      });
    const auto two = [&](std::vector<DatapathTable>& to, double low, double high, auto method) {
      for (const int which : {0, 1})
        to.emplace_back(low, high, most, [&](double x) {
          double values[2];
          (exact_.*method)(x, values[0], values[1]);
          return values[which];
        });
    };
    two(angle_, -1, 1, &TersoffExact::angle);
    const double longest = kLongestStretch * range.nearest / kNearest;
    if (stretched) two(stretch_, -longest, longest, &TersoffExact::stretch);
    two(order_, kLeastZeta * range.zeta, kMostZeta * range.zeta, &TersoffExact::order);
  }

  void bond(const Number& r2, DatapathBond<Number>& out) const {
    Number* const to[] = {&out.inverse_r,  &out.cut,  &out.cut_slope, &out.push,
                          &out.push_slope, &out.pull, &out.pull_slope};
    for (size_t k = 0; k < bond_.size(); ++k) *to[k] = bond_[k](r2);
  }
  void angle(const Number& cosine, Number& g, Number& slope) const { look(angle_, cosine, g, slope); }
  void stretch(const Number& x, Number& value, Number& over) const { look(stretch_, x, value, over); }
  void order(const Number& zeta, Number& b, Number& slope) const { look(order_, zeta, b, slope); }

  void note_words(SampleNode& node) const {
    node.bond_words = bond_[0].words(), node.angle_words = angle_[0].words();
    node.stretch_words = stretched ? stretch_[0].words() : 0, node.order_words = order_[0].words();
  }

 private:
  static void look(const std::vector<DatapathTable>& tables, const Number& x, Number& a, Number& b) {
    a = tables[0](x), b = tables[1](x);
  }
  TersoffExact exact_;
  std::vector<DatapathTable> bond_, angle_, stretch_, order_;

 public:
  bool stretched;
};

// The bonds of the lattice: they stay, as the samples' strains are small.
struct Bonds {
  std::vector<uint32_t> first, other;
  std::vector<Vec3> image;
};

Bonds bonds_of(const AtomicLattice& lattice, double cutoff) {
  std::vector<Vec3> x;
  for (const Vec3& place : lattice.place) x.push_back(lattice.cell * place);
  BondList list(cutoff, 0, 1);
  list.update({lattice.cell, {true, true, true}}, x);
  Bonds out{{0}, {}, {}};
  for (size_t i = 0; i < x.size(); ++i) {
    for (uint32_t row = list.first_row()[i]; row < list.first_row()[i + 1]; ++row) {
      const size_t at = list.entry()[row] / 4;
      if (at == i) continue;
      const bool ghost = at >= list.slots();
      const BondList::Ghost image =
          ghost ? list.ghosts()[at - list.slots()] : BondList::Ghost{static_cast<uint32_t>(at), {0, 0, 0}};
      out.other.push_back(image.owner);
      out.image.emplace_back(image.image[0], image.image[1], image.image[2]);
    }
    out.first.push_back(static_cast<uint32_t>(out.other.size()));
  }
  return out;
}

NodeSample sample_of(const Bonds& bonds, const Mat3& cell, const std::vector<Vec3>& x) {
  const auto triple = [](const Vec3& v) {
    return NodeSample::Triple{Number(v[0]), Number(v[1]), Number(v[2])};
  };
  NodeSample out;
  for (const Vec3& one : x) out.x.push_back(triple(one));
  out.first = bonds.first;
  for (size_t k = 0; k < bonds.other.size(); ++k)
    out.bonds.push_back({bonds.other[k], triple(cell * bonds.image[k])});
  return out;
}

// Of an atom of the lattice at rest.
Ranges ranges_of(const AtomicLattice& lattice, const Bonds& bonds, const TersoffTerm<double>& term) {
  std::vector<Vec3> d;
  for (uint32_t k = 0; k < bonds.first[1]; ++k)
    d.push_back(lattice.cell * (lattice.place[bonds.other[k]] + bonds.image[k] - lattice.place[0]));
  Ranges out{d[0].norm() * kNearest, term.R + term.D, 0};
  for (size_t k = 1; k < d.size(); ++k) {
    const double r = d[k].norm(), cosine = d[0].dot(d[k]) / (d[0].norm() * r);
    out.zeta += tersoff_cutoff(term, r).value * tersoff_angle(term, cosine).value *
                tersoff_stretch(term, d[0].norm() - r).value;
  }
  return out;
}

Mat3 symmetric(const std::array<Number, 6>& v) {
  Mat3 out;
  out << v[0].value(), v[5].value(), v[4].value(), v[5].value(), v[1].value(), v[3].value(), v[4].value(),
      v[3].value(), v[2].value();
  return out;
}

// A strain of all six components.
Mat3 strain_of(double size) {
  Mat3 out;
  out << 1, 0.4, -0.3, 0.4, -0.6, 0.5, -0.3, 0.5, 0.2;
  return size * out;
}

// A sample and what computes it, in doubles and in the node's numbers.
class Counting {
 public:
  Counting(const SampleMaterial& material, const TersoffTerm<double>& term, const SampleNodeOptions& options)
      : material_(material), options_(options), term_(scaled(term)) {
    tally_.quantum = std::exp2(-options.fraction);
    Number::tally = &tally_;
    bonds_ = bonds_of(material.lattice, term.R + term.D);
    if (bonds_.first[1] < 2)
      throw InputError("no node is counted for a lattice whose atoms have no two bonds");
    tables_.emplace(term_, ranges_of(material.lattice, bonds_, term_), options.table_words);
  }
  ~Counting() { Number::tally = nullptr; }
  Counting(const Counting&) = delete;
  Counting& operator=(const Counting&) = delete;

  SampleNode count() {
    SampleNode out;
    out.atoms = material_.lattice.place.size(), out.bonds = bonds_.other.size();
    for (size_t i = 0; i + 1 < bonds_.first.size(); ++i) {
      const uint64_t n = bonds_.first[i + 1] - bonds_.first[i];
      out.pairs += n * (n - 1) / 2;
    }
    tables_->note_words(out);
    count_depth(out);
    compare_forces(out);
    relax(out);
    out.fraction = options_.fraction;
    out.width = options_.fraction + 1 + static_cast<int>(std::ceil(std::log2(tally_.largest)));
    if (tally_.outside) throw InputError("the sample leaves the tables of the node");
    return out;
  }

 private:
  NodeSample placed(const Mat3& cell, double shake) const {
    std::vector<Vec3> x;
    for (const Vec3& place : material_.lattice.place) {
      const auto n = static_cast<double>(x.size());
      x.push_back(cell * place + shake * Vec3(std::sin(5 * n), std::sin(7 * n + 1), std::sin(11 * n + 2)));
    }
    return sample_of(bonds_, cell, x);
  }

  // Of the first atom alone: sums over all atoms are no part of the path.
  void count_depth(SampleNode& out) const {
    NodeSample one = placed(material_.lattice.cell, kShake);
    one.first = {0, bonds_.first[1]};
    Forces forces;
    TersoffDatapath<Number, NodeTables>(*tables_).evaluate(one, forces);
    for (const auto& f : forces.f)
      for (const Number& component : f) out.depth = std::max(out.depth, component.depth());
  }

  void compare_forces(SampleNode& out) {
    NodeSample sample = placed(material_.lattice.cell, kShake);
    Forces forces;
    OperationCounts last = tally_.counts;
    TersoffDatapath<Number, NodeTables>(*tables_).evaluate(sample, forces, [&](DatapathStage stage) {
      out.stages[static_cast<size_t>(stage)] += tally_.counts - last;
      last = tally_.counts;
    });
    std::vector<Vec3> x, f(out.atoms);
    for (const auto& at : sample.x) x.emplace_back(at[0].value(), at[1].value(), at[2].value());
    Mat3 virial;
    material_.law->forces()->evaluate(material_.lattice.cell, x, f, virial);
    double most = 0, error = 0;
    for (size_t i = 0; i < f.size(); ++i)
      for (size_t a = 0; a < 3; ++a) {
        const double exact = f[i][static_cast<int>(a)];
        most = std::max(most, std::abs(exact));
        error = std::max(error, std::abs(forces.f[i][a].value() - exact));
      }
    out.force_error = error / most;
  }

  // eV, the virial at rest; the sample begins as the lattice is strained.
  Mat3 rest(const Mat3& cell, uint32_t& evaluations) {
    NodeSample sample = placed(cell, 0);
    Forces forces;
    const auto quotient = [&](const Number& way, const Number& bend) {
      ++tally_.counts.divisions;
      return Number(bend.value() > 0 ? std::clamp(way.value() / bend.value(), 0.1, 10.0) : 1.0);
    };
    evaluations = relax_by_datapath(*tables_, sample, forces, Number(1 / material_.relaxation.stiffness),
                                    Number(kRests * tally_.quantum), kMost, quotient);
    if (evaluations >= kMost)
      throw InputError(fmt::format("a node of {} bits behind the point finds no rest in {} evaluations",
                                   options_.fraction, kMost),
                       "it needs more bits");
    return symmetric(forces.virial);
  }

  // The node's own stress without strain, which its tables leave, is known and is taken off.
  void relax(SampleNode& out) {
    uint32_t unused = 0;
    const Mat3 before = rest(material_.lattice.cell, unused);
    const OperationCounts begin = tally_.counts;
    const Mat3 cell = (Mat3::Identity() + strain_of(options_.strain)) * material_.lattice.cell;
    const Mat3 virial = rest(cell, out.evaluations) - before;
    out.relaxation = tally_.counts - begin;
    std::vector<Vec3> place = material_.lattice.place;
    const SampleAnswer exact =
        relax_sample(*material_.law->forces(), cell, place, {1e-9, material_.relaxation.stiffness});
    const Mat3 found = kPascal / std::abs(cell.determinant()) * virial;
    out.stress_error = (found - exact.stress).cwiseAbs().maxCoeff() / exact.stress.cwiseAbs().maxCoeff();
  }

  const SampleMaterial& material_;
  SampleNodeOptions options_;
  TersoffTerm<double> term_;
  DatapathTally tally_;
  Bonds bonds_;
  std::optional<NodeTables> tables_;
};

}  // namespace

OperationCounts SampleNode::evaluation() const {
  OperationCounts sum;
  for (const OperationCounts& stage : stages) sum += stage;
  return sum;
}

double SampleNode::cycles_of_evaluation() const {
  return static_cast<double>(std::max(bonds, pairs) + atoms) + depth + width;
}

SampleNode count_sample_node(const SampleMaterial& material, const TersoffTerm<double>& term,
                             const SampleNodeOptions& options) {
  return Counting(material, term, options).count();
}

}  // namespace cuboct
