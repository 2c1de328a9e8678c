// SPDX-License-Identifier: MIT
#include "model/trace/frame.h"

#include <algorithm>
#include <limits>
#include <string_view>

namespace cuboct {
namespace {

// Of the elements, by atomic number.
constexpr std::string_view kSymbols =
    " H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr Rb "
    "Sr Y "
    "Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy Ho Er Tm Yb Lu Hf Ta W "
    "Re Os "
    "Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U Np Pu Am Cm Bk Cf Es Fm Md No Lr Rf Db Sg Bh Hs Mt Ds Rg "
    "Cn "
    "Nh Fl Mc Lv Ts Og ";

bool is_symbol(const std::string& name) {
  return !name.empty() && name.find(' ') == std::string::npos &&
         kSymbols.find(" " + name + " ") != std::string_view::npos;
}

}  // namespace

const std::vector<std::string> kVectorNames{"x", "y", "z"};

FrameType frame_type(const std::string& name, double mass, const std::string& element) {
  const size_t end = std::min(name.find('/'), name.size());
  FrameType type{name.substr(0, end), end < name.size() ? name.substr(end + 1) : std::string()};
  type.mass = mass;
  for (const std::string& symbol : {type.material, element})
    if (is_symbol(symbol)) type.species = symbol;
  return type;
}

std::vector<FrameField> frame_fields(const FrameStyle& style) {
  std::vector<FrameField> fields{
      {"velocity", "m/s", kVectorNames, false,
       [](const Frame& f, size_t i, size_t a) { return f.v[i][static_cast<int>(a)]; }},
      {"radius", "m", {}, false, [radius = style.radius](const Frame&, size_t, size_t) { return radius; }},
      {"axial_strain", "1", {}, false, [](const Frame& f, size_t i, size_t) { return f.strain[i]; }},
      {"strain", "1", kTensorNames, false,
       [](const Frame& f, size_t i, size_t k) { return static_cast<double>(f.tensor[i][k]); }},
      {"broken_bonds", "1", {}, true, [](const Frame& f, size_t i, size_t) {
         return static_cast<double>(f.broken[i]);
       }}};
  for (size_t k = 0; k < style.own.size(); ++k) {
    FrameField field = style.own[k];
    field.value = [k, numbers = field.numbers()](const Frame& f, size_t i, size_t c) {
      return k < f.own.size() ? f.own[k][i * numbers + c] : std::numeric_limits<double>::quiet_NaN();
    };
    fields.push_back(std::move(field));
  }
  return fields;
}

std::string unit_text(const FrameStyle& style, const std::string& unit) {
  return style.reduced && unit != "1" ? "reduced" : unit;
}

FrameBox box_of(const Frame& frame, const FrameStyle& style) {
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  bool any = false;
  for (const Vec3& x : frame.x) {
    lower = any ? Vec3(lower.cwiseMin(x)) : x;
    upper = any ? Vec3(upper.cwiseMax(x)) : x;
    any = true;
  }
  FrameBox box{lower - Vec3::Constant(style.radius), upper - lower + Vec3::Constant(2 * style.radius)};
  const Periodic& periodic = frame.box ? *frame.box : style.periodic;
  for (int axis = 0; axis < 3; ++axis)
    if (periodic.extent[axis] > 0) {
      box.lower[axis] = periodic.origin[axis];
      box.extent[axis] = periodic.extent[axis];
    }
  return box;
}

}  // namespace cuboct
