// SPDX-License-Identifier: MIT
// Both formats are written by hand: extended XYZ is plain text, and the few tags of a VTK point set do not
// justify the VTK libraries (over 100 packages on Debian) in every build.
#include "model/frames.h"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <iterator>
#include <type_traits>

#include "model/base64.h"
#include "model/output.h"

namespace cuboct {
namespace {

// OVITO splits species at blanks.
std::string species(const FrameStyle& style, uint8_t type) {
  std::string name = type < style.types.size() ? style.types[type] : fmt::format("type{}", type);
  for (char& c : name)
    if (c == ' ' || c == '\t') c = '_';
  return name;
}

struct Box {
  Vec3 lower, extent;
};

Box box_of(const std::vector<Frame>& frames, const FrameStyle& style) {
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  bool any = false;
  for (const Frame& frame : frames)
    for (const Vec3& x : frame.x) {
      lower = any ? Vec3(lower.cwiseMin(x)) : x;
      upper = any ? Vec3(upper.cwiseMax(x)) : x;
      any = true;
    }
  Box box{lower - Vec3::Constant(style.radius), upper - lower + Vec3::Constant(2 * style.radius)};
  for (int axis = 0; axis < 3; ++axis)
    if (style.periodic.extent[axis] > 0) {
      box.lower[axis] = style.periodic.origin[axis];
      box.extent[axis] = style.periodic.extent[axis];
    }
  return box;
}

// A DataArray in VTK's inline binary form: base64 of a 32-bit byte count and the values, little-endian.
template <typename T>
std::string data_array(const std::string& attributes, const std::vector<T>& values) {
  static_assert(std::endian::native == std::endian::little, "the header says LittleEndian");
  const char* type = std::is_same_v<T, double> ? "Float64" : std::is_same_v<T, uint32_t> ? "UInt32" : "UInt8";
  const uint32_t bytes = static_cast<uint32_t>(values.size() * sizeof(T));
  std::string raw(sizeof bytes + bytes, '\0');
  std::copy_n(reinterpret_cast<const char*>(&bytes), sizeof bytes, raw.begin());
  std::copy_n(reinterpret_cast<const char*>(values.data()), bytes, raw.begin() + sizeof bytes);
  return fmt::format("        <DataArray type=\"{}\" {} format=\"binary\">{}</DataArray>\n", type, attributes,
                     base64(raw.data(), raw.size()));
}

std::vector<double> flat(const std::vector<Vec3>& triples) {
  std::vector<double> values;
  for (const Vec3& t : triples) values.insert(values.end(), {t.x(), t.y(), t.z()});
  return values;
}

std::string vtp(const Frame& frame, const FrameStyle& style) {
  const auto n = static_cast<uint32_t>(frame.x.size());
  std::vector<uint32_t> ids(n), ends(n);
  for (uint32_t i = 0; i < n; ++i) ids[i] = i, ends[i] = i + 1;
  std::string out =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n"
      "  <PolyData>\n";
  out += fmt::format(
      "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n      <PointData Scalars=\"axial_strain\" Vectors=\"velocity\">\n",
      n, n);
  out += data_array("Name=\"axial_strain\"", frame.strain);
  out += data_array("Name=\"velocity\" NumberOfComponents=\"3\"", flat(frame.v));
  out += data_array("Name=\"type\"", frame.type);
  out += data_array("Name=\"id\"", ids);
  out += data_array("Name=\"radius\"", std::vector<double>(n, style.radius));
  out += "      </PointData>\n      <Points>\n";
  out += data_array("Name=\"position\" NumberOfComponents=\"3\"", flat(frame.x));
  out += "      </Points>\n      <Verts>\n";
  out += data_array("Name=\"connectivity\"", ids);
  out += data_array("Name=\"offsets\"", ends);
  out += "      </Verts>\n    </Piece>\n  </PolyData>\n</VTKFile>\n";
  return out;
}

}  // namespace

void write_extended_xyz(const std::string& path, const std::vector<Frame>& frames, const FrameStyle& style) {
  const Box box = box_of(frames, style);
  const auto flag = [&](int axis) { return style.periodic.extent[axis] > 0 ? 'T' : 'F'; };
  std::string out;
  for (const Frame& frame : frames) {
    fmt::format_to(
        std::back_inserter(out),
        "{}\nLattice=\"{:.9g} 0 0 0 {:.9g} 0 0 0 {:.9g}\" Origin=\"{:.9g} {:.9g} {:.9g}\" "
        "pbc=\"{} {} {}\" "
        "Properties=id:I:1:species:S:1:pos:R:3:velo:R:3:Radius:R:1:AxialStrain:R:1 Step={} Time={:.9g}\n",
        frame.x.size(), box.extent[0], box.extent[1], box.extent[2], box.lower[0], box.lower[1], box.lower[2],
        flag(0), flag(1), flag(2), frame.step, frame.time);
    for (size_t i = 0; i < frame.x.size(); ++i)
      fmt::format_to(std::back_inserter(out),
                     "{} {} {:.9g} {:.9g} {:.9g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g}\n", i,
                     species(style, frame.type[i]), frame.x[i][0], frame.x[i][1], frame.x[i][2],
                     frame.v[i][0], frame.v[i][1], frame.v[i][2], style.radius, frame.strain[i]);
  }
  write_text(path, out);
}

void write_vtk(const std::string& stem, const std::vector<Frame>& frames, const FrameStyle& style) {
  const std::string name = std::filesystem::path(stem).filename().string();
  std::string list =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  const auto file = [&stem](size_t k) { return fmt::format("{}_{:06}.vtp", stem, k); };
  for (size_t k = 0; k < frames.size(); ++k) {
    write_text(file(k), vtp(frames[k], style));
    list += fmt::format("    <DataSet timestep=\"{:.9g}\" part=\"0\" file=\"{}_{:06}.vtp\"/>\n",
                        frames[k].time, name, k);
  }
  for (size_t k = frames.size(); std::filesystem::remove(file(k)); ++k) {  // of an earlier, longer run
  }
  write_text(stem + ".pvd", list + "  </Collection>\n</VTKFile>\n");
}

}  // namespace cuboct
