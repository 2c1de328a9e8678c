// SPDX-License-Identifier: MIT
// Both formats are written by hand: extended XYZ is plain text, and the few tags of a VTK point set do not
// justify the VTK libraries (over 100 packages on Debian) in every build.
#include "model/trace/frames.h"

#include <fmt/compile.h>
#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <filesystem>
#include <iterator>
#include <new>
#include <type_traits>

#include "model/base/base64.h"
#include "model/base/error.h"
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

// Writes the DataArrays of one file in VTK's packed inline form: base64 of the number of blocks, their size,
// that of a last one that is shorter (0: none) and their packed sizes, then base64 of all blocks.
// Little-endian.
class VtkArrays {
 public:
  explicit VtkArrays(TextFile& file) : file_(file) {}

  // value(k) for k = 0 ... count - 1.
  template <typename T, typename Value>
  void write(const std::string& attributes, size_t count, Value value) {
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
    file_.write("</DataArray>\n");
  }
  template <typename T>
  void triples(const std::string& attributes, const std::vector<Vec3>& values) {
    write<T>(attributes + " NumberOfComponents=\"3\"", 3 * values.size(),
             [&](size_t k) { return static_cast<T>(values[k / 3][static_cast<int>(k % 3)]); });
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
constexpr std::array<size_t, 6> kVtkOrder{0, 1, 2, 3, 5, 4};

void write_vtp(TextFile& out, const Frame& frame, const FrameStyle& style) {
  const size_t n = frame.x.size();
  VtkArrays arrays(out);
  out.write(fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
      "compressor=\"vtkZLibDataCompressor\">\n"
      "  <PolyData>\n"
      "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n      <PointData Scalars=\"axial_strain\" Vectors=\"velocity\">\n",
      n, n));
  const auto index = [](size_t k) { return static_cast<uint32_t>(k); };
  arrays.write<float>("Name=\"axial_strain\"", n,
                      [&](size_t k) { return static_cast<float>(frame.strain[k]); });
  arrays.write<float>("Name=\"strain\" NumberOfComponents=\"6\"", 6 * n,
                      [&](size_t k) { return frame.tensor[k / 6][kVtkOrder[k % 6]]; });
  arrays.write<uint32_t>("Name=\"broken_bonds\"", n, [&](size_t k) { return frame.broken[k]; });
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

struct FrameText::Packer {
  Packer() {
    // 16 + the window's bits: with gzip's head. Neither time nor name stands in it.
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Packer() { deflateEnd(&stream); }
  Packer(const Packer&) = delete;
  Packer& operator=(const Packer&) = delete;

  void add(const char* text, size_t size, int flush, GrowingFile& to) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text));
    stream.avail_in = static_cast<uInt>(size);
    do {
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = static_cast<uInt>(out.size());
      deflate(&stream, flush);
      to.write(out.data(), out.size() - stream.avail_out);
    } while (stream.avail_out == 0);
  }

  z_stream stream{};
  std::array<char, 1 << 16> out{};
};

FrameText::FrameText(const std::string& path, bool packed)
    : file_(path), packer_(packed ? std::make_unique<Packer>() : nullptr) {}
FrameText::~FrameText() = default;

void FrameText::write(const char* text, size_t size) {
  if (!packer_) return file_.write(text, size);
  try {
    packer_->add(text, size, Z_NO_FLUSH, file_);
  } catch (const InputError&) {
    deflateReset(&packer_->stream);  // the frame's beginning is gone from the file
    throw;
  }
}

void FrameText::commit() {
  if (packer_) {
    const auto begin_anew = [&] { deflateReset(&packer_->stream); };
    try {
      packer_->add(nullptr, 0, Z_FINISH, file_);
    } catch (const InputError&) {
      begin_anew();
      throw;
    }
    begin_anew();
  }
  file_.commit();
}

namespace {

constexpr size_t kTextBlock = 1 << 16;

// line(out, i) for each particle, in pieces.
template <typename Line>
void write_lines(FrameText& file, fmt::memory_buffer& out, size_t count, Line line) {
  for (size_t i = 0; i < count; ++i) {
    line(std::back_inserter(out), i);
    if (out.size() < kTextBlock) continue;
    file.write(out.data(), out.size());
    out.clear();
  }
  file.write(out.data(), out.size());
  file.commit();
}

}  // namespace

XyzWriter::XyzWriter(const std::string& path, const FrameStyle& style, bool packed)
    : style_(style), file_(path, packed) {
  for (int type = 0; type < 256; ++type) names_.push_back(species(style, static_cast<uint8_t>(type)));
}

void XyzWriter::add(const Frame& frame) {
  const Box box = box_of(frame, style_);
  const auto flag = [&](int axis) { return style_.periodic.extent[axis] > 0 ? 'T' : 'F'; };
  const std::string radius = fmt::format("{:.6g}", style_.radius);
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out),
                 "{}\nLattice=\"{:.9g} 0 0 0 {:.9g} 0 0 0 {:.9g}\" Origin=\"{:.9g} {:.9g} {:.9g}\" "
                 "pbc=\"{} {} {}\" Properties=id:I:1:species:S:1:pos:R:3:velo:R:3:Radius:R:1:AxialStrain:R:1:"
                 "StrainTensor:R:6:BrokenBonds:I:1 Step={} Time={:.9g}\n",
                 frame.x.size(), box.extent[0], box.extent[1], box.extent[2], box.lower[0], box.lower[1],
                 box.lower[2], flag(0), flag(1), flag(2), frame.step, frame.time);
  write_lines(file_, out, frame.x.size(), [&](auto to, size_t i) {
    const Vec3 &x = frame.x[i], &v = frame.v[i];
    const auto& e = frame.tensor[i];
    fmt::format_to(
        to,
        FMT_COMPILE("{} {} {:.9g} {:.9g} {:.9g} {:.6g} {:.6g} {:.6g} {} {:.6g} {:.5g} {:.5g} {:.5g} "
                    "{:.5g} {:.5g} {:.5g} {}\n"),
        i, names_[frame.type[i]], x[0], x[1], x[2], v[0], v[1], v[2], radius, frame.strain[i], e[0], e[1],
        e[2], e[3], e[4], e[5], frame.broken[i]);
  });
}

LammpsWriter::LammpsWriter(const std::string& path, const FrameStyle& style)
    : style_(style), file_(path, true) {}

void LammpsWriter::add(const Frame& frame) {
  const Box box = box_of(frame, style_);
  const std::string radius = fmt::format("{:.6g}", style_.radius);
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "ITEM: UNITS\nsi\nITEM: TIME\n{:.9g}\nITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\n",
                 frame.time, frame.step, frame.x.size());
  std::string ends;
  for (int axis = 0; axis < 3; ++axis) ends += style_.periodic.extent[axis] > 0 ? " pp" : " ff";
  fmt::format_to(to, "ITEM: BOX BOUNDS{}\n", ends);
  for (int axis = 0; axis < 3; ++axis)
    fmt::format_to(to, "{:.9g} {:.9g}\n", box.lower[axis], box.lower[axis] + box.extent[axis]);
  fmt::format_to(to,
                 "ITEM: ATOMS id type x y z vx vy vz radius StrainTensor.XX StrainTensor.YY StrainTensor.ZZ "
                 "StrainTensor.XY StrainTensor.XZ StrainTensor.YZ AxialStrain BrokenBonds\n");
  write_lines(file_, out, frame.x.size(), [&](auto line, size_t i) {
    const Vec3 &x = frame.x[i], &v = frame.v[i];
    const auto& e = frame.tensor[i];
    fmt::format_to(
        line,
        FMT_COMPILE("{} {} {:.9g} {:.9g} {:.9g} {:.6g} {:.6g} {:.6g} {} {:.5g} {:.5g} {:.5g} {:.5g} "
                    "{:.5g} {:.5g} {:.6g} {}\n"),
        i, frame.type[i] + 1, x[0], x[1], x[2], v[0], v[1], v[2], radius, e[0], e[1], e[2], e[3], e[4], e[5],
        frame.strain[i], frame.broken[i]);
  });
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
