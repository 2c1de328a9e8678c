// SPDX-License-Identifier: MIT
#include "model/trace/frames.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "model/base/base64.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/trace/vtk_frames.h"
#include "tests/support/file_limit.h"
#include "tests/support/folder.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

std::string unpacked(const fs::path& path) {
  std::string text;
  gzFile file = gzopen(path.c_str(), "rb");
  char block[1 << 12];
  for (int size = 0; (size = gzread(file, block, sizeof block)) > 0;)
    text.append(block, static_cast<size_t>(size));
  EXPECT_EQ(gzclose(file), Z_OK) << path;
  return text;
}

std::string decoded(const std::string& text) {
  static const std::string kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t word = 0;
  int bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    word = word << 6 | static_cast<uint32_t>(kAlphabet.find(c));
    if ((bits += 6) >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 255);
  }
  return bytes;
}

// Of an array of a .vtp file, by VTK's description of its packed form: count of blocks, their size, that of a
// last shorter one, the packed sizes; then the blocks.
template <typename T>
std::vector<T> values_of(const std::string& vtp, const std::string& name) {
  const size_t at = vtp.find('>', vtp.find("Name=\"" + name + "\"")) + 1;
  const std::string text = vtp.substr(at, vtp.find('<', at) - at);
  const auto numbers = [&](size_t count) {
    const std::string head = decoded(text.substr(0, (count * 8 + 2) / 3 * 4));
    std::vector<uint64_t> list(count);
    std::memcpy(list.data(), head.data(), count * 8);
    return list;
  };
  const uint64_t blocks = numbers(1)[0];
  const std::vector<uint64_t> head = numbers(3 + blocks);
  const std::string packed = decoded(text.substr(((3 + blocks) * 8 + 2) / 3 * 4));
  std::vector<T> values;
  size_t from = 0;
  for (uint64_t k = 0; k < blocks; ++k) {
    uLongf size = k + 1 == blocks && head[2] > 0 ? head[2] : head[1];
    const size_t before = values.size();
    values.resize(before + size / sizeof(T));
    EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(values.data() + before), &size,
                         reinterpret_cast<const Bytef*>(packed.data()) + from, head[3 + k]),
              Z_OK);
    from += head[3 + k];
  }
  EXPECT_EQ(from, packed.size());
  return values;
}

void write_extended_xyz(const fs::path& path, const std::vector<Frame>& frames, const FrameStyle& style) {
  XyzWriter out(path, style);
  for (const Frame& frame : frames) out.add(frame);
}

void write_vtk(const fs::path& stem, const std::vector<Frame>& frames, const FrameStyle& style) {
  VtkWriter out(stem, style);
  for (const Frame& frame : frames) out.add(frame);
}

class Frames : public testing::Test {
 protected:
  void SetUp() override {
    for (int k = 0; k < 2; ++k) {
      Frame frame;
      frame.step = 10u * k;
      frame.time = 0.5 * k;
      frame.x = {Vec3(0, 0, 0), Vec3(1, 2 + k, 3)};
      frame.v = {Vec3(0, 0, 0), Vec3(0, 0.5, 0)};
      frame.type = {0, 1};
      frame.strain = {0, 0.125 * k};
      frame.tensor = {{}, {0.25f, 0, 0, 0.5f, 0, -1e-3f}};
      frame.broken = {0, 3u * k};
      frame.own = {{0, 0.25 * k}, {1, 2, 3, 4, 5, 6}};
      frames_.push_back(frame);
    }
    style_.radius = 0.5;
    style_.types = {frame_type("delrin", 1), frame_type("Cu/top grip", 2)};
    style_.own = {{"damage", "1"}, {"flux", "J/m^2", kVectorNames}};
    style_.periodic = {Vec3(-1, 0, 0), Vec3(4, 0, 0)};
  }

  const test::Folder folder_;
  const fs::path directory_ = folder_.path();
  std::vector<Frame> frames_;
  FrameStyle style_;
};

constexpr const char* kRest = "radius:R:1:axial_strain:R:1:strain:R:6:broken_bonds:I:1:damage:R:1:flux:R:3";

TEST_F(Frames, ExtendedXyzHoldsBoxColumnsUnitsAndTimes) {
  write_extended_xyz(directory_ / "f.xyz", frames_, style_);
  // Along y, which has no period, the second frame reaches farther.
  const auto head = [](const std::string& y) {
    return "2\nLattice=\"4 0 0 0 " + y +
           " 0 0 0 4\" Origin=\"-1 -0.5 -0.5\" pbc=\"T F F\" "
           "Properties=species:S:1:pos:R:3:id:I:1:type_index:I:1:material:S:1:constraint:S:1:velo:R:3:" +
           kRest +
           " units=\"Time:s Lattice:m Origin:m pos:m velo:m/s radius:m axial_strain:1 strain:1 "
           "broken_bonds:1 "
           "damage:1 flux:J/m^2\" ";
  };
  EXPECT_EQ(read_text(directory_ / "f.xyz"),
            head("3") +
                "Step=0 Time=0\n"
                "X 0 0 0 0 0 delrin - 0 0 0 0.5 0 0 0 0 0 0 0 0 0 1 2 3\n"
                "Cu 1 2 3 1 1 Cu top_grip 0 0.5 0 0.5 0 0.25 0 0 0.5 0 -0.001 0 0 4 5 6\n" +
                head("4") +
                "Step=10 Time=0.5\n"
                "X 0 0 0 0 0 delrin - 0 0 0 0.5 0 0 0 0 0 0 0 0 0 1 2 3\n"
                "Cu 1 3 3 1 1 Cu top_grip 0 0.5 0 0.5 0.125 0.25 0 0 0.5 0 -0.001 3 "
                "0.25 4 5 6\n");
}

// Angstrom, u, and momenta in sqrt(u eV): 1 u at 1 sqrt(eV/u), 9822.694750 m/s, has 1.
TEST_F(Frames, ExtendedXyzMayBeInTheUnitsOfAse) {
  constexpr double kU = 1.66053906660e-27;  // kg
  style_.types = {frame_type("delrin", 2 * kU), frame_type("Cu", 63 * kU)};
  style_.radius = 1e-10;
  style_.periodic = {};
  Frame& frame = frames_[0];
  frame.x = {Vec3(0, 0, 0), Vec3(2e-10, 0, 3e-10)};
  frame.v = {Vec3(9822.69475, 0, 0), Vec3(0, 0, -9822.69475)};
  {
    XyzWriter out((directory_ / "f.xyz").string(), style_, {.ase = true});
    out.add(frame);
  }
  EXPECT_EQ(read_text(directory_ / "f.xyz"),
            "2\nLattice=\"4 0 0 0 2 0 0 0 5\" Origin=\"-1 -1 -1\" pbc=\"F F F\" "
            "Properties=species:S:1:pos:R:3:id:I:1:type_index:I:1:material:S:1:constraint:S:1:momenta:R:3:" +
                std::string(kRest) +
                ":masses:R:1 units=\"Time:s Lattice:angstrom Origin:angstrom pos:angstrom momenta:sqrt(u*eV) "
                "radius:angstrom axial_strain:1 strain:1 broken_bonds:1 damage:1 flux:J/m^2 masses:u\" "
                "Step=0 Time=0\n"
                "X 0 0 0 0 0 delrin - 2 0 0 1 0 0 0 0 0 0 0 0 0 1 2 3 2\n"
                "Cu 2 0 3 1 1 Cu - 0 0 -63 1 0 0.25 0 0 0.5 0 -0.001 0 0 4 5 6 63\n");
}

TEST(FrameTypes, ASpeciesIsAnElementOrX) {
  const auto species = [](const std::string& name, const std::string& element = {}) {
    return frame_type(name, 1, element).species;
  };
  EXPECT_EQ(species("Cu"), "Cu");
  EXPECT_EQ(species("W/held"), "W");
  for (const char* other : {"Matter", "steel", "cu", "CU", "", "Si O", "i", "He Li"})
    EXPECT_EQ(species(other), "X");
  EXPECT_EQ(species("Matter/held", "Si"), "Si");
  EXPECT_EQ(species("Cu/held", "Si"), "Si");  // the atoms are what the potential says
  EXPECT_EQ(species("Matter", "Si1"), "X");   // a name of a file that is no symbol
  EXPECT_EQ(frame_type("a b/c d", 1).material, "a b");
  EXPECT_EQ(frame_type("a b/c d", 1).constraint, "c d");
  EXPECT_EQ(frame_type("a b", 1).constraint, "");
}

// A rule whose fields an engine did not hand over: they are not known.
TEST_F(Frames, FieldsThatAreNotThereAreNoNumbers) {
  frames_[0].own.clear();
  write_extended_xyz(directory_ / "f.xyz", {frames_[0]}, style_);
  EXPECT_TRUE(read_text(directory_ / "f.xyz").ends_with(" nan nan nan nan\n"));
}

TEST_F(Frames, ReducedUnitsAreCalledSo) {
  style_.reduced = true;
  write_extended_xyz(directory_ / "f.xyz", frames_, style_);
  EXPECT_NE(read_text(directory_ / "f.xyz")
                .find("units=\"Time:reduced Lattice:reduced Origin:reduced pos:reduced "
                      "velo:reduced radius:reduced axial_strain:1 "),
            std::string::npos);
  {
    LammpsWriter out((directory_ / "f.gz").string(), style_);
    out.add(frames_[0]);
  }
  EXPECT_TRUE(unpacked(directory_ / "f.gz").starts_with("ITEM: UNITS\nlj\n"));
}

TEST_F(Frames, VtkListsItsFilesAndHoldsTheValues) {
  write_vtk(directory_ / "f", frames_, style_);
  EXPECT_EQ(read_text(directory_ / "f.pvd"),
            "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
            "  <Collection>\n"
            "    <DataSet timestep=\"0\" part=\"0\" file=\"f_000000.vtp\"/>\n"
            "    <DataSet timestep=\"0.5\" part=\"0\" file=\"f_000001.vtp\"/>\n"
            "  </Collection>\n"
            "</VTKFile>\n");
  const std::string vtp = read_text(directory_ / "f_000001.vtp");
  EXPECT_EQ(values_of<float>(vtp, "axial_strain"), (std::vector<float>{0, 0.125f}));
  // In VTK's order: xx, yy, zz, xy, yz, xz.
  EXPECT_EQ(values_of<float>(vtp, "strain"),
            (std::vector<float>{0, 0, 0, 0, 0, 0, 0.25f, 0, 0, 0.5f, -1e-3f, 0}));
  EXPECT_NE(vtp.find("ComponentName4=\"yz\" ComponentName5=\"xz\""), std::string::npos);
  EXPECT_NE(vtp.find("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">J/m^2</InformationKey>"),
            std::string::npos);
  EXPECT_EQ(values_of<uint32_t>(vtp, "broken_bonds"), (std::vector<uint32_t>{0, 3}));
  EXPECT_EQ(values_of<float>(vtp, "damage"), (std::vector<float>{0, 0.25f}));
  EXPECT_EQ(values_of<float>(vtp, "flux"), (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(values_of<uint8_t>(vtp, "type_index"), (std::vector<uint8_t>{0, 1}));
  EXPECT_EQ(values_of<uint32_t>(vtp, "offsets"), (std::vector<uint32_t>{1, 2}));
  EXPECT_NE(vtp.find("NumberOfPoints=\"2\""), std::string::npos);
}

TEST_F(Frames, LammpsDumpCountsFromOne) {
  {
    LammpsWriter out((directory_ / "f.gz").string(), style_);
    for (const Frame& frame : frames_) out.add(frame);
  }
  const auto head = [](const std::string& time, const std::string& step, const std::string& y) {
    return "ITEM: UNITS\nsi\nITEM: TIME\n" + time + "\nITEM: TIMESTEP\n" + step +
           "\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp ff ff\n-1 3\n-0.5 " + y +
           "\n-0.5 3.5\nITEM: ATOMS id type x y z vx vy vz radius axial_strain strain_xx strain_yy strain_zz "
           "strain_xy strain_xz strain_yz broken_bonds damage flux_x flux_y flux_z\n"
           "1 1 0 0 0 0 0 0 0.5 0 0 0 0 0 0 0 0 0 1 2 3\n";
  };
  EXPECT_EQ(unpacked(directory_ / "f.gz"),
            head("0", "0", "2.5") + "2 2 1 2 3 0 0.5 0 0.5 0 0.25 0 0 0.5 0 -0.001 0 0 4 5 6\n" +
                head("0.5", "10", "3.5") +
                "2 2 1 3 3 0 0.5 0 0.5 0.125 0.25 0 0 0.5 0 -0.001 3 0.25 4 5 6\n");
}

TEST_F(Frames, PackedXyzIsXyz) {
  write_extended_xyz(directory_ / "f.xyz", frames_, style_);
  {
    XyzWriter out((directory_ / "f.gz").string(), style_, {.packed = true});
    for (const Frame& frame : frames_) {
      out.add(frame);
      EXPECT_FALSE(unpacked(directory_ / "f.gz").empty());  // whole as it grows
    }
  }
  EXPECT_EQ(unpacked(directory_ / "f.gz"), read_text(directory_ / "f.xyz"));
}

// More than the writers' buffers hold: against the array encoded at once, and line by line.
TEST_F(Frames, LargeFramesAreWhole) {
  constexpr uint32_t n = 70'001;
  Frame frame;
  std::vector<double> position;
  std::string lines;
  for (uint32_t i = 0; i < n; ++i) {
    const Vec3 x(i, 0.5 * i, -3.0 * i);
    frame.x.push_back(x);
    frame.v.push_back(Vec3(0, 0.25, i % 7));
    frame.type.push_back(static_cast<uint8_t>(i % 2));
    frame.strain.push_back(0.125);
    frame.tensor.push_back({});
    frame.broken.push_back(i);
    position.insert(position.end(), {x[0], x[1], x[2]});
    std::ostringstream line;
    line.precision(9);
    line << (i % 2 == 0 ? "X " : "Cu ") << x[0] << ' ' << x[1] << ' ' << x[2] << ' ' << i
         << (i % 2 == 0 ? " 0 delrin - " : " 1 Cu top_grip ") << "0 0.25 " << i % 7
         << " 0.5 0.125 0 0 0 0 0 0 " << i << "\n";
    lines += line.str();
  }
  style_.own.clear();
  write_vtk(directory_ / "f", {frame}, style_);
  const std::string vtp = read_text(directory_ / "f_000000.vtp");
  EXPECT_EQ(values_of<double>(vtp, "position"), position);
  EXPECT_EQ(values_of<uint32_t>(vtp, "broken_bonds"), frame.broken);
  write_extended_xyz(directory_ / "f.xyz", {frame}, style_);
  const std::string xyz = read_text(directory_ / "f.xyz");
  EXPECT_EQ(xyz.substr(xyz.find("Time=0\n") + 7), lines);
}

TEST_F(Frames, VtkLeavesNoFilesOfALongerRun) {
  write_vtk(directory_ / "f", frames_, style_);
  const size_t before = frames_.size();
  ASSERT_GE(before, 2U);
  frames_.pop_back();
  write_vtk(directory_ / "f", frames_, style_);
  const auto file = [&](size_t k) { return directory_ / ("f_00000" + std::to_string(k) + ".vtp"); };
  EXPECT_TRUE(std::filesystem::exists(file(before - 2)));
  EXPECT_FALSE(std::filesystem::exists(file(before - 1)));
}

// Each is whole before the next one comes: a run that dies leaves them.
TEST_F(Frames, AreThereAsTheyCome) {
  XyzWriter xyz(directory_ / "f.xyz", style_);
  VtkWriter vtk(directory_ / "f", style_);
  EXPECT_EQ(read_text(directory_ / "f.xyz"), "");
  for (size_t k = 0; k < frames_.size(); ++k) {
    xyz.add(frames_[k]);
    vtk.add(frames_[k]);
    const std::string text = read_text(directory_ / "f.xyz"), list = read_text(directory_ / "f.pvd");
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), static_cast<ptrdiff_t>(4 * (k + 1)));
    EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), static_cast<ptrdiff_t>(6 + k));
    EXPECT_TRUE(list.ends_with("</VTKFile>\n"));
  }
}

// A frame that does not fit is left out whole, one that fits behind it is there.
TEST_F(Frames, ThatDoNotFitAreLeftOut) {
  Frame large;
  large.x.resize(100'000, Vec3::Zero());
  large.v = large.x;
  large.type.resize(large.x.size());
  large.strain.resize(large.x.size());
  large.tensor.resize(large.x.size());
  large.broken.resize(large.x.size());
  for (size_t i = 0; i < large.x.size(); ++i) large.x[i] = Vec3::Constant(std::sin(i));  // does not pack
  XyzWriter xyz(directory_ / "f.xyz", style_);
  VtkWriter vtk(directory_ / "f", style_);
  xyz.add(frames_[0]);
  vtk.add(frames_[0]);
  {
    const FileLimit limit(1 << 20);
    EXPECT_THROW(xyz.add(large), InputError);
    EXPECT_THROW(vtk.add(large), InputError);
    xyz.add(frames_[1]);
    vtk.add(frames_[1]);
  }
  const std::string text = read_text(directory_ / "f.xyz"), list = read_text(directory_ / "f.pvd");
  write_extended_xyz(directory_ / "g.xyz", frames_, style_);
  write_vtk(directory_ / "f", frames_, style_);
  EXPECT_EQ(text, read_text(directory_ / "g.xyz"));
  EXPECT_EQ(list, read_text(directory_ / "f.pvd"));
  size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(directory_)) ++files;
  EXPECT_EQ(files, 5u);
}

// The vectors of RFC 4648, section 10.
TEST(Base64, FollowsTheStandard) {
  const std::pair<const char*, const char*> cases[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : cases) EXPECT_EQ(base64(plain, std::string(plain).size()), coded);
}

}  // namespace
}  // namespace cuboct
