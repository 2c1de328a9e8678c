// SPDX-License-Identifier: MIT
// Written by hand: the few tags of a VTK point set do not justify the VTK libraries (over 100 packages on
// Debian) in every build.
#include "model/trace/vtk_frames.h"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <filesystem>
#include <new>
#include <type_traits>

#include "model/base/base64.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

template <typename T>
constexpr const char* kVtkType = std::is_same_v<T, double>     ? "Float64"
                                 : std::is_same_v<T, float>    ? "Float32"
                                 : std::is_same_v<T, uint32_t> ? "UInt32"
                                                               : "UInt8";

// Writes the DataArrays of one file in VTK's packed inline form: base64 of the number of blocks, their size,
// that of a last one that is shorter (0: none) and their packed sizes, then base64 of all blocks.
// Little-endian.
class VtkArrays {
 public:
  explicit VtkArrays(TextFile& file) : file_(file) {}

  // value(k) for k = 0 ... count - 1. `unit`: told by the array's information, where VTK has a key for it.
  template <typename T, typename Value>
  void write(const std::string& attributes, size_t count, Value value, const std::string& unit = {}) {
    static_assert(std::endian::native == std::endian::little, "the header says LittleEndian");
    file_.write(fmt::format("        <DataArray type=\"{}\" {} format=\"binary\">", kVtkType<T>, attributes));
    head_ = {0, kBlock, 0};
    for (size_t k = 0; k < count; ++k) {
      const T one = value(k);
      const auto* at = reinterpret_cast<const uint8_t*>(&one);
      block_.insert(block_.end(), at, at + sizeof one);
      if (block_.size() == kBlock) pack();
    }
    head_[2] = block_.size();
    if (!block_.empty()) pack();
    file_.write(base64(head_.data(), head_.size() * sizeof head_[0]));
    file_.write(base64(packed_.data(), packed_.size()));
    packed_.clear();
    if (!unit.empty())
      file_.write(
          fmt::format("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>",
                      html_text(unit)));
    file_.write("</DataArray>\n");
  }

 private:
  static constexpr size_t kBlock = 1 << 18;  // bytes, of all types a multiple

  void pack() {
    uLongf size = compressBound(block_.size());
    const size_t before = packed_.size();
    packed_.resize(before + size);
    if (compress2(packed_.data() + before, &size, block_.data(), block_.size(), Z_BEST_SPEED) != Z_OK)
      throw std::bad_alloc();  // the one way in which it can fail here
    packed_.resize(before + size);
    ++head_[0];
    head_.push_back(size);
    block_.clear();
  }

  TextFile& file_;
  std::vector<uint64_t> head_;
  std::vector<uint8_t> block_, packed_;
};

// VTK's symmetric tensors go xx, yy, zz, xy, yz, xz.
size_t vtk_place(const FrameField& field, size_t number) {
  constexpr std::array<size_t, 6> kOrder{0, 1, 2, 3, 5, 4};
  return field.numbers() == kOrder.size() ? kOrder[number] : number;
}

void write_field(VtkArrays& arrays, const FrameField& field, const Frame& frame, const FrameStyle& style) {
  const size_t n = field.numbers();
  std::string attributes = fmt::format("Name=\"{}\"", html_text(field.name));
  if (n > 1) attributes += fmt::format(" NumberOfComponents=\"{}\"", n);
  for (size_t c = 0; c < field.components.size(); ++c)
    attributes += fmt::format(" ComponentName{}=\"{}\"", c, html_text(field.components[vtk_place(field, c)]));
  const auto value = [&](size_t k) { return field.value(frame, k / n, vtk_place(field, k % n)); };
  const std::string unit = unit_text(style, field.unit);
  if (field.whole)
    arrays.write<uint32_t>(
        attributes, n * frame.x.size(), [&](size_t k) { return static_cast<uint32_t>(value(k)); }, unit);
  else
    arrays.write<float>(
        attributes, n * frame.x.size(), [&](size_t k) { return static_cast<float>(value(k)); }, unit);
}

// An array of strings, as VTK's text form has it: the codes of the characters, a 0 behind each string.
std::string string_array(const std::string& name, const std::vector<std::string>& strings) {
  std::string text =
      fmt::format("      <Array type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">", name,
                  strings.size());
  for (const std::string& string : strings) {
    for (const char c : string) text += fmt::format("{} ", static_cast<unsigned char>(c));
    text += "0 ";
  }
  return text + "</Array>\n";
}

void write_vtp(TextFile& out, const Frame& frame, const FrameStyle& style,
               const std::vector<FrameField>& fields) {
  const size_t n = frame.x.size();
  VtkArrays arrays(out);
  std::vector<std::string> materials, constraints;
  for (const FrameType& type : style.types)
    materials.push_back(type.material), constraints.push_back(type.constraint);
  out.write(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
      "compressor=\"vtkZLibDataCompressor\">\n"
      "  <PolyData>\n    <FieldData>\n" +
      string_array("material", materials) + string_array("constraint", constraints) +
      fmt::format(
          "    </FieldData>\n"
          "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
          "NumberOfPolys=\"0\">\n      <PointData Scalars=\"axial_strain\" Vectors=\"velocity\">\n",
          n, n));
  const auto index = [](size_t k) { return static_cast<uint32_t>(k); };
  for (const FrameField& field : fields) write_field(arrays, field, frame, style);
  arrays.write<uint8_t>("Name=\"type_index\"", n, [&](size_t k) { return frame.type[k]; });
  arrays.write<uint32_t>("Name=\"id\"", n, index);
  out.write("      </PointData>\n      <Points>\n");
  arrays.write<double>(
      "Name=\"position\" NumberOfComponents=\"3\"", 3 * n,
      [&](size_t k) { return frame.x[k / 3][static_cast<int>(k % 3)]; }, unit_text(style, "m"));
  out.write("      </Points>\n      <Verts>\n");
  arrays.write<uint32_t>("Name=\"connectivity\"", n, index);
  arrays.write<uint32_t>("Name=\"offsets\"", n, [](size_t k) { return static_cast<uint32_t>(k + 1); });
  out.write("      </Verts>\n    </Piece>\n  </PolyData>\n</VTKFile>\n");
}

}  // namespace

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
      fields_(frame_fields(style)),
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
  write_text(path, [&](TextFile& out) { write_vtp(out, frame, style_, fields_); });
  list_.write(fmt::format("    <DataSet timestep=\"{:.9g}\" part=\"0\" file=\"{}\"/>\n", frame.time,
                          html_text(std::filesystem::path(path).filename().string())));
  list_.commit();
  ++count_;
}

}  // namespace cuboct
