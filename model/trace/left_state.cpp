// SPDX-License-Identifier: MIT
#include "model/trace/left_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/trace/hdf5_file.h"

namespace cuboct {
namespace {

using hdf5::Handle;
using hdf5::Reader;

Vec3 vector_in(const Reader& in, const std::string& name) {
  const Handle attribute(H5Aopen(in.root(), name.c_str(), H5P_DEFAULT), H5Aclose,
                         in.missing("attribute", name));
  const Handle space(H5Aget_space(attribute), H5Sclose, in.missing("attribute", name));
  Vec3 value;
  if (H5Sget_simple_extent_npoints(space) != 3 || H5Aread(attribute, H5T_NATIVE_DOUBLE, value.data()) < 0)
    throw InputError(in.missing("vector", name));
  return value;
}

[[noreturn]] void holds_none(const Reader& in) {
  throw InputError(fmt::format("{} holds no state to begin with", in.path()),
                   "a run with --no-states keeps none");
}

void check_types(const Reader& in, const LeftState& left) {
  for (const uint8_t type : left.body.type) in.same_length(type < left.types.size(), "types and particles");
}

Widths widths_in(const Reader& in) {
  Widths w;
  const auto number = [&](const char* name) { return int{in.number<int32_t>(in.root(), name)}; };
  w.position_frac = number("position_frac");
  w.guard = number("guard");
  w.difference_frac = number("difference_frac");
  w.relative_velocity_frac = number("relative_velocity_frac");
  constexpr int kMost = 52;  // bits of velocity_frac, which is their sum
  if (w.position_frac < 1 || w.position_frac > kMost || w.guard < 0 || w.guard > kMost ||
      w.velocity_frac() > kMost)
    throw InputError(in.missing("width", "guard"));
  return w;
}

// Rows of the last frame, by id.
void read_fixed(const Reader& in, LeftState& left) {
  const Handle group = in.group(in.root(), "frames");
  const auto step = in.array<uint64_t>(group, "step");
  const auto first = in.array<int64_t>(group, "first");
  if (step.empty()) holds_none(in);
  in.same_length(
      first.size() == step.size() + 1 && std::is_sorted(first.begin(), first.end()) && first[0] >= 0,
      "the frames' fields");
  left.step = step.back();
  const auto begin = static_cast<hsize_t>(first[step.size() - 1]);
  const hsize_t count = static_cast<hsize_t>(first.back()) - begin;

  auto exact = std::make_shared<ExactBody>();
  exact->widths = widths_in(in);
  exact->cell_edge = in.number<double>(in.root(), "cell_edge");
  if (in.has_attribute(in.root(), "cell_shape")) {
    const Vec3 shape = vector_in(in, "cell_shape");
    if (!(shape.minCoeff() > 0) || !(shape.maxCoeff() <= 1))
      throw InputError(in.missing("three numbers above 0, at most 1,", "cell_shape"));
    exact->shape = {shape[0], shape[1], shape[2]};
  }
  exact->dt = in.number<double>(in.root(), "dt");
  exact->origin = vector_in(in, "origin");
  if (!(exact->cell_edge > 0) || !(exact->dt > 0) || !std::isfinite(exact->cell_edge) ||
      !exact->origin.allFinite())
    throw InputError(in.missing("number above 0", "cell_edge"));
  const Handle lattice = in.group(in.root(), "lattice");
  const auto cells = in.array<int32_t>(lattice, "cell", {3});

  Body& body = left.body;
  uint32_t row = 0;
  in.rows<uint32_t>(group, "id", begin, count, 1,
                    [&](const uint32_t* id) { in.same_length(*id == row++, "ids and particles"); });
  in.rows<uint8_t>(group, "type", begin, count, 1, [&](const uint8_t* type) { body.type.push_back(*type); });
  in.rows<uint32_t>(group, "node", begin, count, 1, [&](const uint32_t* cell) {
    in.same_length(*cell < cells.size() / 3, "cells and particles");
    exact->cell.push_back({cells[3 * *cell], cells[3 * *cell + 1], cells[3 * *cell + 2]});
  });
  const int64_t most = int64_t{1} << 53;
  const auto triple = [&](const char* name, std::vector<Int3>& to) {
    in.rows<int64_t>(group, name, begin, count, 3, [&](const int64_t* v) {
      for (int a = 0; a < 3; ++a) in.same_length(-most < v[a] && v[a] < most, "values and widths");
      to.push_back({v[0], v[1], v[2]});
    });
  };
  triple("x", exact->x), triple("v", exact->v), triple("u", exact->u);
  for (const Int3& x : exact->x)
    for (const int64_t c : x)
      in.same_length(c >= 0 && c >> exact->widths.velocity_frac() == 0, "values and widths");

  const CellEdges edges(exact->cell_edge, exact->shape);
  body.x.resize(count), body.v.resize(count), body.u.resize(count);
  for (size_t id = 0; id < count; ++id)
    for (size_t a = 0; a < 3; ++a) {
      const double edge = edges[static_cast<int>(a)], unit = std::ldexp(edge, -exact->widths.velocity_frac());
      body.x[id][a] =
          exact->origin[a] + exact->cell[id][a] * edge + static_cast<double>(exact->x[id][a]) * unit;
      body.v[id][a] = static_cast<double>(exact->v[id][a]) * unit / exact->dt;
      body.u[id][a] = static_cast<double>(exact->u[id][a]) * unit;
    }
  body.exact = std::move(exact);
}

void read_real(const Reader& in, LeftState& left) {
  const Handle group = in.group(in.root(), "bodies");
  const auto step = in.array<uint64_t>(group, "step");
  const hsize_t rows = in.length(group, "x");
  Body& body = left.body;
  body.type = in.array<uint8_t>(group, "type");
  const hsize_t count = body.type.size();
  in.same_length(!step.empty() && rows == count * step.size(), "the bodies' fields");
  left.step = step.back();
  const auto triple = [&](const char* name, std::vector<Vec3>& to) {
    in.rows<double>(group, name, rows - count, count, 3, [&](const double* v) {
      to.emplace_back(v[0], v[1], v[2]);
      in.same_length(to.back().allFinite(), "values and numbers");
    });
  };
  triple("x", body.x), triple("v", body.v);
  if (in.has(group, "u")) triple("u", body.u);
  if (in.has(group, "bonds"))
    body.bonds = std::make_shared<BondState>(BondState{{}, in.array<uint64_t>(group, "bonds")});
}

}  // namespace

LeftState read_left_state(const std::string& path) {
  const Reader in(path);
  if (!in.has_attribute(in.root(), "packing"))
    throw InputError(fmt::format("{} does not say whose particles it holds", path),
                     "'cuboct run --out DIR' leaves a trace that does");
  LeftState left;
  left.engine = in.text(in.root(), "engine");
  left.packing = in.number<uint64_t>(in.root(), "packing");
  left.types = in.names(in.root(), "types");
  if (in.has_attribute(in.root(), "first_step"))
    left.first_step = in.number<uint64_t>(in.root(), "first_step");
  if (in.has(in.root(), "bodies"))
    read_real(in, left);
  else if (in.has(in.root(), "frames") && in.has_attribute(in.root(), "cell_edge"))
    read_fixed(in, left);
  else
    holds_none(in);
  check_types(in, left);
  if (in.has_attribute(in.root(), "box_strain")) {
    left.box_strain =
        vector_in(in, "box_strain") + static_cast<double>(left.step) * vector_in(in, "box_strain_per_step");
    if (!(left.box_strain.minCoeff() > -1) || !left.box_strain.allFinite())
      throw InputError(in.missing("three numbers above -1", "box_strain"));
  }
  return left;
}

}  // namespace cuboct
