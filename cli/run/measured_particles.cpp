// SPDX-License-Identifier: MIT
#include "cli/run/measured_particles.h"

#include <fmt/format.h>

#include <limits>
#include <optional>

#include "cli/run/outputs.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/trace/frames.h"
#include "model/trace/vtk_frames.h"

namespace cuboct {

class ParticlesFile::Form {
 public:
  virtual ~Form() = default;
  virtual void add(const KeptFrame& kept, const Snapshot& now, const MeasuredParticles& particles) = 0;
  virtual void remove() = 0;  // what is written
};

namespace {

class CsvForm : public ParticlesFile::Form {
 public:
  CsvForm(const std::string& path, const Scene& scene) : path_(path), scene_(scene), file_(path) {}

  void add(const KeptFrame&, const Snapshot& now, const MeasuredParticles& particles) override {
    fmt::memory_buffer out;
    const auto to = std::back_inserter(out);
    const bool reduced = scene_.boltzmann == 1;
    const auto name = [&](const std::string& of, const std::string& unit) {
      fmt::format_to(to, ",{}", of);
      if (!reduced && unit != "1") fmt::format_to(to, " ({})", unit);
    };
    if (!begun_) {
      fmt::format_to(to, "step,id,type");
      for (const char* axis : {"x", "y", "z"}) name(axis, "m");
      if (particles.components.empty()) name(particles.name, particles.unit);
      for (const std::string& component : particles.components)
        name(particles.name + "_" + component, particles.unit);
      out.push_back('\n');
    }
    begun_ = true;
    const size_t numbers = std::max<size_t>(1, particles.components.size());
    const Body& body = now.body;
    for (size_t i = 0; i < body.size(); ++i) {
      fmt::format_to(to, "{},{},{},{},{},{}", now.step, i, body.type[i], body.x[i][0], body.x[i][1],
                     body.x[i][2]);
      for (size_t k = 0; k < numbers; ++k) {
        const double value = particles.values[i * numbers + k];
        if (particles.whole)
          fmt::format_to(to, ",{}", static_cast<uint64_t>(value));
        else
          fmt::format_to(to, ",{}", value);
      }
      out.push_back('\n');
      if (out.size() < kPiece) continue;
      file_.write(out.data(), out.size());
      out.clear();
    }
    file_.write(out.data(), out.size());
    file_.commit();
  }
  void remove() override { discard(path_); }

 private:
  static constexpr size_t kPiece = 1 << 16;
  std::string path_;
  const Scene& scene_;
  GrowingFile file_;
  bool begun_ = false;
};

enum class Viewer : uint8_t { xyz, packed_xyz, lammps, vtk };

// The columns of a run's frames, and one more.
class ViewerForm : public ParticlesFile::Form {
 public:
  // `path`: of VTK without its ending.
  ViewerForm(Viewer viewer, std::string path, const Loaded& loaded)
      : viewer_(viewer),
        path_(std::move(path)),
        style_(frame_style(loaded.scene)),
        rule_fields_(style_.own.size()),
        maker_(loaded, true) {}

  void add(const KeptFrame& kept, const Snapshot&, const MeasuredParticles& particles) override {
    Frame frame = std::visit([&](const auto* one) { return maker_.make(*one); }, kept);
    frame.own.resize(rule_fields_);
    for (size_t k = 0; k < rule_fields_; ++k)  // of states of integers they are not known
      if (frame.own[k].empty())
        frame.own[k].assign(frame.x.size() * style_.own[k].numbers(),
                            std::numeric_limits<double>::quiet_NaN());
    frame.own.push_back(particles.values);
    if (!begun_) {
      FrameField field{particles.name, particles.unit, particles.components};
      field.whole = particles.whole;
      style_.own.push_back(std::move(field));
      if (viewer_ == Viewer::vtk)
        vtk_.emplace(path_, style_);
      else if (viewer_ == Viewer::lammps)
        lammps_.emplace(path_, style_);
      else
        xyz_.emplace(path_, style_, XyzForm{.packed = viewer_ == Viewer::packed_xyz});
    }
    begun_ = true;
    if (vtk_) vtk_->add(frame);
    if (lammps_) lammps_->add(frame);
    if (xyz_) xyz_->add(frame);
  }
  void remove() override {
    if (!begun_) return;
    vtk_.reset(), lammps_.reset(), xyz_.reset();
    if (viewer_ == Viewer::vtk)
      remove_vtk(path_);
    else
      discard(path_);
  }

 private:
  const Viewer viewer_;
  const std::string path_;
  FrameStyle style_;
  const size_t rule_fields_;
  const FrameMaker maker_;
  std::optional<XyzWriter> xyz_;
  std::optional<LammpsWriter> lammps_;
  std::optional<VtkWriter> vtk_;
  bool begun_ = false;
};

}  // namespace

ParticlesFile::ParticlesFile(const std::string& path, const Loaded& loaded)
    : path_(path), temporary_(temporary_beside(path)), loaded_(loaded) {
  const auto viewer = [&](Viewer kind, const std::string& written) {
    check_writable(path);
    form_ = std::make_unique<ViewerForm>(kind, written, loaded_);
  };
  if (path.ends_with(".csv")) {
    check_writable(path);
    form_ = std::make_unique<CsvForm>(temporary_, loaded.scene);
  } else if (path.ends_with(".xyz")) {
    viewer(Viewer::xyz, temporary_);
  } else if (path.ends_with(".xyz.gz")) {
    viewer(Viewer::packed_xyz, temporary_);
  } else if (path.ends_with(".dump.gz")) {
    viewer(Viewer::lammps, temporary_);
  } else if (path.ends_with(".pvd")) {  // a list of files beside it, by their names
    temporary_.clear();
    viewer(Viewer::vtk, path.substr(0, path.size() - 4));
  } else {
    throw InputError(fmt::format("--particles: '{}' names no format", path),
                     "by its ending: .csv, .xyz, .xyz.gz, .dump.gz (LAMMPS) or .pvd (ParaView)");
  }
}

ParticlesFile::~ParticlesFile() {
  if (!finished_) form_->remove();
}

void ParticlesFile::add(const KeptFrame& kept, const Snapshot& now, const MeasuredParticles& particles) {
  form_->add(kept, now, particles);
}

void ParticlesFile::finish() {
  finished_ = true;
  if (!temporary_.empty()) rename_whole(temporary_, path_);
}

}  // namespace cuboct
