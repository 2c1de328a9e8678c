// SPDX-License-Identifier: MIT
// Both formats are written by hand: extended XYZ is plain text, and the few tags of a VTK point set do not
// justify the VTK libraries (over 100 packages on Debian) in every build.
#include "model/trace/frames.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <iterator>
#include <type_traits>

#include "model/base/base64.h"
#include "model/base/output.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

std::string species(const FrameStyle& style, uint8_t type) {
  return xyz_word(type < style.types.size() ? style.types[type] : fmt::format("type{}", type));
}

struct Box {
  Vec3 lower, extent;
};

Box box_of(const Frame& frame, const FrameStyle& style) {
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  bool any = false;
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

template <typename T>
constexpr const char* kVtkType = std::is_same_v<T, double>     ? "Float64"
                                 : std::is_same_v<T, float>    ? "Float32"
                                 : std::is_same_v<T, uint32_t> ? "UInt32"
                                                               : "UInt8";

// Writes the DataArrays of one file in VTK's inline binary form: base64 of a byte count and the values,
// little-endian.
class VtkArrays {
 public:
  VtkArrays(TextFile& file, size_t points) : file_(file), points_(points) {}

  // The widest array decides on the width of all counts.
  const char* header_type() const { return wide() ? "UInt64" : "UInt32"; }

  // value(k) for k = 0 ... count - 1.
  template <typename T, typename Value>
  void write(const std::string& attributes, size_t count, Value value) {
    static_assert(std::endian::native == std::endian::little, "the header says LittleEndian");
    file_.write(fmt::format("        <DataArray type=\"{}\" {} format=\"binary\">", kVtkType<T>, attributes));
    const uint64_t bytes = count * sizeof(T);
    add(&bytes, wide() ? 8 : 4);
    for (size_t k = 0; k < count; ++k) {
      const T one = value(k);
      add(&one, sizeof one);
    }
    flush(true);
    file_.write("</DataArray>\n");
  }
  template <typename T>
  void triples(const std::string& attributes, const std::vector<Vec3>& values) {
    write<T>(attributes + " NumberOfComponents=\"3\"", 3 * values.size(),
             [&](size_t k) { return static_cast<T>(values[k / 3][static_cast<int>(k % 3)]); });
  }

 private:
  static constexpr size_t kBlock = 3 << 14;  // base64 takes three bytes at a time

  bool wide() const { return points_ * 3 * sizeof(double) > UINT32_MAX; }
  void add(const void* data, size_t bytes) {
    const auto* at = static_cast<const char*>(data);
    block_.insert(block_.end(), at, at + bytes);
    if (block_.size() >= kBlock) flush(false);
  }
  void flush(bool all) {
    const size_t bytes = all ? block_.size() : block_.size() / 3 * 3;
    file_.write(base64(block_.data(), bytes));
    block_.erase(block_.begin(), block_.begin() + static_cast<ptrdiff_t>(bytes));
  }

  TextFile& file_;
  size_t points_;
  std::vector<char> block_;
};

void write_vtp(TextFile& out, const Frame& frame, const FrameStyle& style) {
  const size_t n = frame.x.size();
  VtkArrays arrays(out, n);
  out.write(fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"{}\">\n"
      "  <PolyData>\n"
      "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n      <PointData Scalars=\"axial_strain\" Vectors=\"velocity\">\n",
      arrays.header_type(), n, n));
  const auto index = [](size_t k) { return static_cast<uint32_t>(k); };
  arrays.write<float>("Name=\"axial_strain\"", n,
                      [&](size_t k) { return static_cast<float>(frame.strain[k]); });
  arrays.triples<float>("Name=\"velocity\"", frame.v);
  arrays.write<uint8_t>("Name=\"type\"", n, [&](size_t k) { return frame.type[k]; });
  arrays.write<uint32_t>("Name=\"id\"", n, index);
  arrays.write<float>("Name=\"radius\"", n, [&](size_t) { return static_cast<float>(style.radius); });
  out.write("      </PointData>\n      <Points>\n");
  arrays.triples<double>("Name=\"position\"", frame.x);
  out.write("      </Points>\n      <Verts>\n");
  arrays.write<uint32_t>("Name=\"connectivity\"", n, index);
  arrays.write<uint32_t>("Name=\"offsets\"", n, [](size_t k) { return static_cast<uint32_t>(k + 1); });
  out.write("      </Verts>\n    </Piece>\n  </PolyData>\n</VTKFile>\n");
}

}  // namespace

XyzWriter::XyzWriter(const std::string& path, const FrameStyle& style) : style_(style), file_(path) {
  for (int type = 0; type < 256; ++type) names_.push_back(species(style, static_cast<uint8_t>(type)));
}

void XyzWriter::add(const Frame& frame) {
  const Box box = box_of(frame, style_);
  const auto flag = [&](int axis) { return style_.periodic.extent[axis] > 0 ? 'T' : 'F'; };
  const std::string radius = fmt::format("{:.6g}", style_.radius);
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(
      to,
      "{}\nLattice=\"{:.9g} 0 0 0 {:.9g} 0 0 0 {:.9g}\" Origin=\"{:.9g} {:.9g} {:.9g}\" "
      "pbc=\"{} {} {}\" "
      "Properties=id:I:1:species:S:1:pos:R:3:velo:R:3:Radius:R:1:AxialStrain:R:1 Step={} Time={:.9g}\n",
      frame.x.size(), box.extent[0], box.extent[1], box.extent[2], box.lower[0], box.lower[1], box.lower[2],
      flag(0), flag(1), flag(2), frame.step, frame.time);
  for (size_t i = 0; i < frame.x.size(); ++i) {
    const Vec3 &x = frame.x[i], &v = frame.v[i];
    fmt::format_to(to, FMT_COMPILE("{} {} {:.9g} {:.9g} {:.9g} {:.6g} {:.6g} {:.6g} {} {:.6g}\n"), i,
                   names_[frame.type[i]], x[0], x[1], x[2], v[0], v[1], v[2], radius, frame.strain[i]);
    if (out.size() < size_t{1} << 16) continue;
    file_.write(out.data(), out.size());
    out.clear();
  }
  file_.write(out.data(), out.size());
  file_.commit();
}

namespace {

std::string vtp_name(const std::string& stem, size_t k) { return fmt::format("{}_{:06}.vtp", stem, k); }

void remove_vtp(const std::string& stem) {
  for (size_t k = 0; std::filesystem::remove(vtp_name(stem, k)); ++k) {
  }
}

}  // namespace

VtkWriter::VtkWriter(const std::string& stem, const FrameStyle& style)
    : stem_(stem),
      style_(style),
      list_(stem + ".pvd",
            "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n",
            "  </Collection>\n</VTKFile>\n") {
  remove_vtp(stem);
}

void remove_vtk(const std::string& stem) {
  std::filesystem::remove(stem + ".pvd");
  remove_vtp(stem);
}

void VtkWriter::add(const Frame& frame) {
  const std::string path = vtp_name(stem_, count_);
  write_text(path, [&](TextFile& out) { write_vtp(out, frame, style_); });
  list_.write(fmt::format("    <DataSet timestep=\"{:.9g}\" part=\"0\" file=\"{}\"/>\n", frame.time,
                          html_text(std::filesystem::path(path).filename().string())));
  list_.commit();
  ++count_;
}

}  // namespace cuboct
