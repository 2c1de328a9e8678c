// SPDX-License-Identifier: MIT
#include "model/contract/quantise.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "model/contract/format_cures.h"
#include "model/contract/law.h"

namespace cuboct {
namespace {

constexpr int kLeastStrength = 18;
constexpr int kLeastIndex = 9, kMostIndex = 13;
constexpr double kBondsFrom = 0.8;  // of the distance at rest: nearer, particles collide
constexpr double kHalfUnit =
    1.7e-4;  // of the strongest pull: where the elastic constants of Lennard-Jones are right to 1 %

constexpr double kMostRatio = 1024;  // of masses: the least weight is 64 units, off by half of one

using Real = std::function<double(double)>;  // of r2 in cell edges squared

// The keys of a scene that give a value to particles of this type.
std::vector<std::string> keys_of(const ParticleType& type, const std::string& key) {
  const size_t slash = type.name.find('/');
  if (slash == std::string::npos) return {key};
  const std::string constraint = fmt::format("constraint[{}]", type.name.substr(slash + 1));
  return {constraint + "." + key, constraint};
}

std::string material_of(const ParticleType& type) {
  return type.name.substr(0, type.name.find_first_of(":/"));  // of a plane of symmetry too
}

std::vector<std::string> strength_keys(const Rule& rule, size_t i, size_t j) {
  const auto material = [&](size_t type) { return material_of(rule.types[type]); };
  std::vector<std::string> keys{fmt::format("bond[{},{}].strength", material(i), material(j))};
  for (const size_t type : {i, j}) keys.push_back(fmt::format("material[{}].strength", material(type)));
  return keys;
}

// What makes the law strong: a material, where one is stronger than the law, or the law.
std::vector<std::string> law_keys(const Rule& rule) {
  std::vector<std::string> keys;
  size_t a = 0, b = 0;
  for (size_t i = 0; i < rule.types.size(); ++i)
    for (size_t j = 0; j < rule.types.size(); ++j)
      if (rule.strength_of(static_cast<int>(i), static_cast<int>(j)) >
          rule.strength_of(static_cast<int>(a), static_cast<int>(b)))
        a = i, b = j;
  if (!rule.types.empty() && rule.strength_of(static_cast<int>(a), static_cast<int>(b)) > 1)
    keys = strength_keys(rule, a, b);
  for (const char* key : {"law.stiffness", "law.youngs_modulus", "law.epsilon", "law.force", "law"})
    keys.emplace_back(key);
  return keys;
}

// A number of the rule that becomes an integer.
struct Quantity {
  const char* what;
  double value;  // in units of the lattice
  double whole;  // length of the vector that it is a component of; a component is as exact as the vector asks
                 // for
  int power;     // it grows as dt^power
  std::vector<std::string> keys;
};

// `keeps`: what keeps it where the fractional bits do not.
int64_t quantised(const Quantity& q, double dt, int frac, int bits,
                  const std::function<std::string()>& keeps) {
  const double scaled = std::ldexp(q.value, frac);
  if (!(std::abs(scaled) < std::ldexp(1.0, bits - 1) - 0.5))
    throw InputError(
        fmt::format(
            "{} is {:.6g} in units of the lattice: {} bits with {} fractional bits hold less than {:.6g}",
            q.what, q.value, bits, frac, std::ldexp(1.0, bits - 1 - frac)),
        dt_that_holds(dt, q.value, std::ldexp(1.0, bits - 1 - frac), q.power))
        .about(q.keys);
  const auto result = std::llround(scaled);
  if (std::abs(static_cast<double>(result) - scaled) > kMostOff * std::abs(std::ldexp(q.whole, frac)))
    throw InputError(
        fmt::format("{} is {:.6g} in units of the lattice: {} fractional bits round it to {:.6g}", q.what,
                    q.value, frac, std::ldexp(static_cast<double>(result), -frac)),
        keeps())
        .about(q.keys);
  return result;
}

int64_t weight_of(const Rule& rule, int type) {
  const double ratio = rule.relative_mass(type);
  const ParticleType& heavy = rule.types[static_cast<size_t>(type)];
  if (ratio > kMostRatio)
    throw InputError(
        fmt::format("a particle of '{}' is {:.6g} times as heavy as the lightest: integers hold at most {}",
                    heavy.name, ratio, kMostRatio),
        "doubles hold any (--engine reference)")
        .about({fmt::format("material[{}].mass", material_of(heavy)),
                fmt::format("material[{}].density", material_of(heavy)), "mass", "density"});
  return std::llround(std::ldexp(1 / ratio, kWeightFrac));
}

// The r2 (cell edges squared) at which bin k of the table starts; the table's end for k = number of bins.
double bin_start(const FixedTable& table, uint32_t k) {
  if (table.shape == TableShape::uniform) return std::ldexp(static_cast<double>(k), -table.index_bits);
  const uint32_t bins = 1u << table.bin_bits;
  const double mantissa = 1.0 + static_cast<double>(k % bins) / bins;
  return std::ldexp(mantissa, table.first_octave + static_cast<int>(k / bins) - 2 * table.difference_frac);
}

uint32_t bins_used(const FixedTable& table) {
  if (table.shape == TableShape::uniform) return 1u << table.index_bits;
  return static_cast<uint32_t>(2 * table.difference_frac - table.first_octave) << table.bin_bits;
}

// A function over one bin of a table.
struct Bin {
  double left = 0, middle = 0, right = 0;

  double curve() const { return 2 * (left + right - 2 * middle); }
};

// A function of r2 over the bins of a table. `end` (cell edges squared), where `continued`: the cutoff, whose
// bin continues its polynomial, as nobody looks beyond. Bins beyond are zero.
std::vector<Bin> bins_of(const FixedTable& table, const Real& value, double end, bool continued) {
  std::vector<Bin> bins(bins_used(table));
  for (uint32_t k = 0; k < bins.size(); ++k) {
    const double a = bin_start(table, k), b = bin_start(table, k + 1);
    if (a >= end) break;
    const double inside = continued ? std::min(b, end * (1 - 1e-12)) : b;
    Bin bin{value(a), value(0.5 * (a + inside)), value(inside)};
    if (inside < b) {  // continue to b the parabola (line) through the part inside the cutoff
      const double h = inside - a, z = (b - a) / h;
      const double c2 = table.degree == 2 ? 2 * (bin.left + bin.right - 2 * bin.middle) : 0;
      const double c1 = bin.right - bin.left - c2, left = bin.left;
      bin = {left, left + c1 * z / 2 + c2 * z * z / 4, left + c1 * z + c2 * z * z};
    }
    bins[k] = bin;
  }
  return bins;
}

// The largest coefficient or value.
double largest_in(const std::vector<Bin>& bins, int degree) {
  double largest = 0;
  for (const Bin& bin : bins) {
    largest = std::max({largest, std::abs(bin.left), std::abs(bin.right), std::abs(bin.right - bin.left)});
    if (degree == 2)
      largest = std::max({largest, std::abs(bin.middle), std::abs(bin.curve()),
                          std::abs(bin.right - bin.left - bin.curve())});
  }
  return largest;
}

// Fills the coefficients, law by law, so that neighbouring bins meet: value(end of k) == value(start of k+1),
// in integers.
void fill(FixedTable& table, const std::vector<std::vector<Bin>>& laws, int value_bits, int headroom) {
  double largest = 0;
  for (size_t n = 0; n < laws.size(); ++n) {
    const double own = largest_in(laws[n], table.degree);
    if (own == 0)
      throw InputError(fmt::format("the pair law{} is zero everywhere inside its cutoff",
                                   laws.size() > 1 ? fmt::format(" {} of {}", n + 1, laws.size()) : ""))
          .about({"law"});
    largest = std::max(largest, own);
  }
  // The largest E with largest * 2^E + 1 (for rounding) < 2^(value_bits-1-headroom).
  const double limit = std::ldexp(1.0, value_bits - 1 - headroom) - 2;
  table.value_frac = static_cast<int>(std::floor(std::log2(limit / largest)));

  const size_t entries = laws.size() << table.index_bits;
  table.c0.assign(entries, 0);
  table.c1.assign(entries, 0);
  table.c2.assign(table.degree == 2 ? entries : 0, 0);
  const auto rounded = [&](double v) {
    return static_cast<int32_t>(std::lround(std::ldexp(v, table.value_frac)));
  };
  for (size_t n = 0; n < laws.size(); ++n)
    for (size_t bin = 0, k = n << table.index_bits; bin < laws[n].size(); ++bin, ++k) {
      const Bin& of = laws[n][bin];
      const int32_t left = rounded(of.left), right = rounded(of.right);
      const int32_t curve = table.degree == 2 ? rounded(of.curve()) : 0;
      table.c0[k] = left;
      table.c1[k] = right - left - curve;
      if (table.degree == 2) table.c2[k] = curve;
    }
}

FixedTable shaped(TableShape shape, const TableChoice& choice, int difference_frac, double core2) {
  FixedTable table;
  table.shape = shape;
  table.degree = choice.degree;
  table.difference_frac = difference_frac;
  table.index_bits = choice.index_bits;
  table.fraction_bits = choice.fraction_bits;
  if (shape == TableShape::uniform) {
    table.fraction_bits = std::min(choice.fraction_bits, 2 * difference_frac - choice.index_bits);
  } else {
    // Rows from the octave that holds the core on: below, every law's f/r is constant.
    table.first_octave = std::clamp(static_cast<int>(std::floor(std::log2(core2))) + 2 * difference_frac, 0,
                                    2 * difference_frac - 1);
    const auto rows = static_cast<unsigned>(2 * difference_frac - table.first_octave);
    table.bin_bits = choice.index_bits - std::bit_width(rows - 1);
  }
  return table;
}

// Of law n over the distances from `nearest` m on.
FixedRule::Error error_of(const FixedRule& fixed, const Rule& rule, size_t n, double scale, double nearest) {
  const PairLaw& law = rule.law_at(n);
  const double last = rule.cutoff() * (1 - 1e-12);
  FixedRule::Error error;
  const FixedTable& table = fixed.force;
  const double unit = std::ldexp(1.0, -table.value_frac) * rule.mass / (rule.dt * rule.dt) / scale;
  // Powers of two, so that no product is rounded.
  const double whole = std::ldexp(1.0, 2 * table.difference_frac), share = 1 / whole;
  double largest = 0;
  constexpr int kSamples = 64;  // per bin
  for (uint32_t k = 0; k < bins_used(table); ++k) {
    const double a = bin_start(table, k), b = bin_start(table, k + 1);
    for (int sample = 0; sample < kSamples; ++sample) {
      const auto r2 = static_cast<uint64_t>((a + (b - a) * (sample + 0.5) / kSamples) * whole);
      if (r2 == 0 || r2 >= fixed.cutoff2) continue;
      const double r = std::sqrt(static_cast<double>(r2) * share) * fixed.cell_edge;
      if (r < nearest) continue;
      const double exact = law.force(std::min(r, last));
      const double off =
          std::abs(static_cast<double>(table.at(r2, static_cast<uint32_t>(n))) * unit * r - exact);
      largest = std::max(largest, std::abs(exact));
      if (off > error.worst_force) error.worst_force = off, error.at = r;
    }
  }
  error.relative = largest > 0 ? error.worst_force / largest : 0;
  return error;
}

// `what`: a key of [widths], a sum of such, or "table index_bits".
void check_range(const std::string& what, int value, int low, int high) {
  if (value < low || value > high)
    throw InputError(fmt::format("{} = {} is out of range: {} to {}", what, value, low, high))
        .about({"widths." + what.substr(0, what.find(' ')), "table." + what.substr(what.find(' ') + 1)});
}

void check_widths(const Widths& w, const TableChoice& table) {
  check_range("position_frac", w.position_frac, 8, 30);
  check_range("guard", w.guard, 1, 30);
  check_range("position_frac + guard", w.velocity_frac(), 9, kMostVelocityFrac);
  check_range("difference_frac", w.difference_frac, 6, std::min(w.position_frac, 24));
  check_range("filter_frac", w.filter_frac, 2, 16);
  check_range("velocity_bits", w.velocity_bits, 8, w.velocity_frac() + 1);
  check_range("relative_velocity_frac", w.relative_velocity_frac, 4, w.velocity_frac());
  check_range("relative_velocity_bits", w.relative_velocity_bits, 4, 27);
  if (w.strength_bits != 0) check_range("strength_bits", w.strength_bits, 8, kWidestStrength);
  check_range("sum_bits", w.sum_bits, 8, 48);
  check_range("displacement_bits", w.displacement_bits, 8, 44);
  check_range("scale_frac", w.scale_frac, 4, 16);
  check_range("gain_frac", w.gain_frac, 4, 24);
  check_range("table index_bits", table.index_bits, 2, std::min(16, 2 * w.difference_frac - 1));
  check_range("table fraction_bits", table.fraction_bits, 1, 24);
  check_range("table degree", table.degree, 1, 2);
}

void make_tables(FixedRule& fixed, const Rule& rule, TableShape shape, const TableChoice& choice,
                 double scale) {
  const double edge = fixed.cell_edge, core = rule.core();
  const auto end = [&](double cutoff) { return cutoff * cutoff / (edge * edge); };
  const int D = fixed.widths.difference_frac;
  const auto distance = [=](double r2) { return std::max(std::sqrt(r2) * edge, 1e-6 * core); };
  fixed.force = shaped(shape, choice, D, core * core / (edge * edge));
  std::vector<std::vector<Bin>> laws;
  for (size_t n = 0; n < rule.laws(); ++n) {
    const PairLaw& law = rule.law_at(n);
    const auto value = [&](double r2) {
      const double r = distance(r2);
      return scale * law.force(r) / r * rule.dt * rule.dt / rule.mass;
    };
    laws.push_back(bins_of(fixed.force, value, end(law.cutoff()), law.cutoff() == rule.cutoff()));
  }
  fill(fixed.force, laws, fixed.widths.strength_bits, fixed.damped ? 1 : 0);
  if (fixed.damped) {
    fixed.damp = shaped(shape, choice, D, core * core / (edge * edge));
    const auto value = [&](double r2) {
      return scale * rule.damping_over_r2(distance(r2)) * edge * edge * rule.dt / rule.mass;
    };
    fill(fixed.damp, {bins_of(fixed.damp, value, end(rule.cutoff()), true)}, fixed.widths.strength_bits, 0);
  }
  fixed.errors.clear();
  for (size_t n = 0; n < rule.laws(); ++n)
    fixed.errors.push_back(error_of(fixed, rule, n, scale, rule.law_at(n).core()));
}

// Strongest pull of the law in newtons; its strongest push if it never pulls.
double strongest_pull(const PairLaw& law) {
  constexpr int kSamples = 4096;
  double pull = 0, push = 0;
  for (int k = 0; k < kSamples; ++k) {
    const double f = law.force(law.core() + (law.cutoff() - law.core()) * k / kSamples);
    pull = std::max(pull, -f);
    push = std::max(push, f);
  }
  return pull > 0 ? pull : push;
}

// Tables of the chosen shape, or of the shape that errs less.
FixedRule with_tables(const FixedRule& fixed, const Rule& rule, const TableChoice& choice, double scale,
                      bool fits_octaves) {
  FixedRule uniform = fixed, octaves = fixed;
  if (choice.shape != TableChoice::Shape::octaves)
    make_tables(uniform, rule, TableShape::uniform, choice, scale);
  if (choice.shape == TableChoice::Shape::uniform || !fits_octaves) return uniform;
  make_tables(octaves, rule, TableShape::octaves, choice, scale);
  if (choice.shape == TableChoice::Shape::octaves) return octaves;
  return octaves.error().worst_force < uniform.error().worst_force ? octaves : uniform;
}

// All but what the law brings.
FixedRule framed(const Rule& rule, const CellEdges& edges, const Widths& widths) {
  const double cutoff = rule.cutoff(), cell_edge = edges.longest;
  if (cutoff > edges.shortest() * (1 + 1e-12))
    throw InputError(
        fmt::format("the cutoff, {:.6g} m, is longer than a cell edge, {:.6g} m", cutoff, edges.shortest()));
  FixedRule fixed;
  fixed.widths = widths;
  fixed.widths.filter_frac = std::min(widths.filter_frac, widths.position_frac);
  fixed.cell_edge = cell_edge;
  fixed.shape = edges.shape;
  fixed.dt = rule.dt;
  fixed.mass = rule.mass;
  fixed.damped = rule.damping.coefficient > 0;

  const int D = widths.difference_frac;
  const double ratio = std::min(1.0, cutoff / cell_edge);
  fixed.cutoff2 = static_cast<uint64_t>(std::llround(std::ldexp(ratio * ratio, 2 * D)));
  if (fixed.cutoff2 == 0)
    throw InputError(
        fmt::format("a cutoff of {:.3g} m is less than a unit of a difference in cells of {:.3g} m", cutoff,
                    cell_edge),
        "a smaller cell_edge, or more bits of difference_frac")
        .about({"node.cell_edge", "widths.difference_frac"});
  // Two that are a whole edge or more apart along an axis do not interact, as each side's rounding has it:
  // only neighbouring cells meet.
  for (int a = 0; a < 3; ++a) {
    const auto edge = static_cast<uint64_t>(shaped_by(fixed, a, int32_t{1} << D));
    fixed.cutoff2 = std::min(fixed.cutoff2, edge * edge);
  }
  set_planar(fixed);
  fixed.difference_shift = widths.position_frac - D;
  fixed.w_shift = widths.velocity_frac() - widths.relative_velocity_frac;
  return fixed;
}

void add_types(const Rule& rule, FixedRule& fixed) {
  const Widths& widths = fixed.widths;
  const int frac = widths.velocity_frac();
  for (const ParticleType& type : rule.types) {
    FixedType t;
    const auto index = static_cast<int>(fixed.types.size());
    t.weight = weight_of(rule, index);
    fixed.weighted = fixed.weighted || t.weight != FixedType{}.weight;
    t.imposed = type.imposed;
    t.pd = type.pd;
    for (int a = 0; a < 3; ++a) {
      const double velocity = rule.dt / fixed.edges()[a], gravity = velocity * rule.dt;
      const Quantity imposed{"an imposed velocity", type.velocity[a] * velocity,
                             type.velocity.norm() * velocity, 1, keys_of(type, "velocity")};
      t.velocity[a] = quantised(imposed, rule.dt, frac, widths.velocity_bits,
                                [&] { return guard_that_keeps(imposed.whole, widths); });
      const bool pulled = !type.pull.isZero(0);
      std::vector<std::string> keys = {"gravity"};
      for (const char* key : {"traction", "force"})
        if (pulled) keys.insert(keys.begin(), keys_of(type, key).front());
      const Quantity weight{pulled ? "the acceleration by a force" : "gravity", type.gravity[a] * gravity,
                            std::max(type.gravity.norm(), type.pull.norm()) * gravity, 2, keys};
      t.gravity[a] = quantised(weight, rule.dt, frac, widths.velocity_bits,
                               [&] { return guard_that_keeps(weight.whole, widths); });
    }
    if (type.pd) {
      const double mass = rule.mass_of(index);
      const double kp = type.kp * rule.dt * rule.dt / mass, kd = type.kd * rule.dt / mass;
      const auto keeps = [&] { return gains_that_are_kept(rule, static_cast<size_t>(index)); };
      t.kp = quantised({"the gain kp", kp, kp, 2, keys_of(type, "kp")}, rule.dt, widths.gain_frac, kGainBits,
                       keeps);
      t.kd = quantised({"the gain kd", kd, kd, 1, keys_of(type, "kd")}, rule.dt, widths.gain_frac, kGainBits,
                       keeps);
      fixed.pd = true;
    }
    fixed.types.push_back(t);
  }
  fixed.type_bits = fixed.types.size() > 1 ? std::bit_width(fixed.types.size() - 1) : 0;
}

}  // namespace

FixedRule quantise(const Rule& rule, const CellEdges& edges, const Widths& widths, const TableChoice& table,
                   double most_half_unit) {
  if (table.index_bits == 0) {
    TableChoice choice = table;
    for (choice.index_bits = kLeastIndex;; ++choice.index_bits) {
      FixedRule fixed = quantise(rule, edges, widths, choice, most_half_unit);
      if (choice.index_bits == std::min(kMostIndex, 2 * widths.difference_frac - 1) ||
          std::isinf(most_half_unit))
        return fixed;
      double scale = 0;
      for (const auto& row : rule.strength)
        scale = std::max(scale, *std::max_element(row.begin(), row.end()));
      double worst = 0;
      for (size_t n = 0; n < rule.laws(); ++n) {
        const PairLaw& law = rule.law_at(n);
        const double nearest = std::max(law.core(), kBondsFrom * stiffest_rest_distance(law));
        worst = std::max(worst, error_of(fixed, rule, n, scale, nearest).worst_force);
      }
      if (worst <= 2 * most_half_unit) return fixed;
    }
  }
  const TableChoice& choice = table;
  check_widths(widths, choice);
  FixedRule fixed = framed(rule, edges, widths);
  const double cutoff = rule.cutoff(), cell_edge = edges.longest;
  const int D = widths.difference_frac;

  double scale = 0;
  for (const auto& row : rule.strength) scale = std::max(scale, *std::max_element(row.begin(), row.end()));
  double least = scale;
  for (const auto& row : rule.strength) least = std::min(least, *std::min_element(row.begin(), row.end()));
  fixed.scaled = least != scale || !rule.contact.empty() || rule.laws() > 1;
  fixed.law_bits = std::bit_width(rule.laws() - 1);
  if (!rule.contact.empty()) {
    const double reach = std::min(rule.contact_distance, cutoff) / cell_edge;
    fixed.contact2 =
        std::min(fixed.cutoff2, static_cast<uint64_t>(std::llround(std::ldexp(reach * reach, 2 * D))));
  }

  // So many bits that an octave has two entries.
  const int octave_index_bits =
      choice.index_bits + 1 -
      shaped(TableShape::octaves, choice, D, std::pow(rule.core() / cell_edge, 2)).bin_bits;
  const bool fits_octaves = choice.index_bits >= octave_index_bits;
  if (choice.shape == TableChoice::Shape::octaves && !fits_octaves)
    throw InputError(
        fmt::format("{} index bits are too few for the octaves between the law's core and its cutoff",
                    choice.index_bits),
        fmt::format("index_bits = {}, or shape = \"uniform\", in the arch file's [table]", octave_index_bits))
        .about({"table.index_bits", "table.shape"});
  if (widths.strength_bits == 0) {
    double pull = std::numeric_limits<double>::infinity();  // of the weakest law
    for (size_t n = 0; n < rule.laws(); ++n) pull = std::min(pull, strongest_pull(rule.law_at(n)));
    for (fixed.widths.strength_bits = kLeastStrength; fixed.widths.strength_bits < kWidestStrength;
         ++fixed.widths.strength_bits) {
      const FixedRule tried = with_tables(fixed, rule, choice, scale, fits_octaves);
      const double half_unit =
          std::ldexp(0.5, -tried.force.value_frac) * rule.mass / (rule.dt * rule.dt) / scale * cutoff;
      const bool kicks = tried.force.value_frac + D >= widths.velocity_frac();
      if (kicks && half_unit <= std::min(kHalfUnit * pull, most_half_unit)) break;
    }
  }
  fixed = with_tables(fixed, rule, choice, scale, fits_octaves);

  const int frac = widths.velocity_frac();
  fixed.q_shift = D + 1;
  fixed.damp_shift =
      fixed.damped ? fixed.damp.value_frac + widths.relative_velocity_frac - 1 - fixed.force.value_frac : 0;
  fixed.kick_shift = fixed.force.value_frac + D - frac;
  if (fixed.kick_shift < 0)
    throw InputError(
        fmt::format("the pair law's f/r * dt^2/m reaches {:.3g}: with {} value bits its kicks have fewer "
                    "fractional bits ({}) than velocities ({})",
                    std::ldexp(1.0, fixed.widths.strength_bits - 1 - fixed.force.value_frac),
                    fixed.widths.strength_bits, fixed.force.value_frac + D, frac),
        kicks_that_fit(fixed.widths, -fixed.kick_shift, rule.dt))
        .about(law_keys(rule));
  if (fixed.damp_shift < 0)
    throw InputError(
        fmt::format("the damping c/r^2 * dt/m reaches {:.3g}: too strong beside the pair law for {} bits",
                    std::ldexp(1.0, fixed.widths.strength_bits - 1 - fixed.damp.value_frac),
                    fixed.widths.strength_bits),
        damping_that_fits(fixed.widths, -fixed.damp_shift))
        .about({"damping.coefficient", "damping.ratio"});

  add_types(rule, fixed);
  if (fixed.scaled)
    for (size_t i = 0; i < rule.types.size(); ++i) {
      fixed.scale.emplace_back();
      if (fixed.law_bits > 0) fixed.law.emplace_back();
      for (size_t j = 0; j < rule.types.size(); ++j) {
        const double strength = rule.strength_of(static_cast<int>(i), static_cast<int>(j)) / scale;
        const auto size = static_cast<int32_t>(
            quantised({"a pair strength", strength, strength, 1, strength_keys(rule, i, j)}, rule.dt,
                      widths.scale_frac, 18, [] { return std::string(kDoublesHold); }));
        fixed.scale[i].push_back(rule.only_touch(static_cast<int>(i), static_cast<int>(j)) ? -size : size);
        if (fixed.law_bits > 0)
          fixed.law[i].push_back(
              static_cast<uint8_t>(rule.law_index_of(static_cast<int>(i), static_cast<int>(j))));
      }
    }
  return fixed;
}

FixedRule quantise_without_law(const Rule& rule, const CellEdges& edges, const Widths& widths) {
  check_widths(widths, {.index_bits = kLeastIndex});
  FixedRule fixed = framed(rule, edges, widths);
  add_types(rule, fixed);
  return fixed;
}

Rule with_masses_of(const FixedRule& fixed, Rule rule) {
  if (rule.masses.empty()) return rule;
  for (size_t k = 0; k < rule.types.size(); ++k)
    rule.masses[static_cast<size_t>(rule.types[k].material)] = mass_of(fixed, static_cast<int>(k));
  return rule;
}

}  // namespace cuboct
