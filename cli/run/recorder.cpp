// SPDX-License-Identifier: MIT
#include "cli/run/recorder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "cli/run/curves.h"
#include "cli/run/plan_text.h"
#include "model/base/directory_lock.h"
#include "model/base/error_parts.h"
#include "model/base/input_file.h"
#include "model/base/output.h"
#include "model/trace/frames.h"
#include "model/trace/raster.h"
#include "model/trace/trace_file.h"
#include "model/trace/vtk_frames.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// Besides what the trace holds: summary, record, the head of each file.
constexpr uint64_t kBesideTrace = 1 << 19;
constexpr uint64_t kMost =
    1 << 28;  // a run of so many steps that its hashes take more may well be ended early

// What a run writes, besides run.toml and pictures.
constexpr const char* kFiles[] = {"trace.h5",      "summary.json",   "plan.txt",       "frames.xyz",
                                  "frames.xyz.gz", "frames.ase.xyz", "frames.dump.gz", "frames.pvd",
                                  "rasters.h5",    "curves.csv"};

void refuse_what_is_kept(const RecorderOptions& options) {
  const std::string& directory = options.directory;
  const bool checkpoint = is_file(directory + "/checkpoint");
  const bool unfinished = checkpoint || is_file(directory + "/checkpoint.journal") ||
                          (is_file(directory + "/run.toml") && !is_over(read_record(directory)));
  if (!is_file(directory + "/run.toml") && !unfinished && !options.force)
    for (const char* name : kFiles)
      if (fs::exists(directory + "/" + name))
        throw InputError(fmt::format("{} holds a file {} that no run left", directory, name),
                         "another --out keeps it; --force puts a run's in its place");
  if (!unfinished || options.resume) return;
  if (!options.force)
    throw InputError(fmt::format("{} holds a run that did not end", directory),
                     checkpoint ? "--resume goes on with it; --force begins anew in its place"
                                : "another --out keeps it; --force begins anew in its place");
}

// A file of the run, or files of a kind, and how many frames they hold.
template <typename Writer>
struct Output {
  std::string name;
  std::optional<Writer> writer{};
  uint64_t frames = 0;
};

}  // namespace

struct Recorder::Impl {
  Impl(RecorderOptions of, const Loaded& loaded)
      : options(std::move(of)),
        loaded(loaded),
        lock(options.directory, "cuboct run"),
        style(frame_style(loaded.scene)),
        maker(loaded, !options.no_states && !options.frames.empty()),
        head(head_of(loaded, options.real, options.si)) {
    head.cells = !options.no_states || options.cycles;
    if (wants("ase") && style.reduced)
      throw InputError("--frames ase is in angstrom, and the scene's units are reduced", "--frames xyz");
    refuse_what_is_kept(options);
    if (!options.resume)
      for (const char* name : {"checkpoint", "checkpoint.journal", "checkpoint.tmp"}) fs::remove(path(name));
    check_writable(path("run.toml"));
    for (const char* name : kFiles) check_writable(path(name));
  }

  std::string path(const std::string& name) const { return options.directory + "/" + name; }

  bool wants(const char* format) const {
    return !options.no_states && std::ranges::count(options.frames, format) > 0;
  }

  // Old files go, so that no directory holds parts of two runs.
  void begin() {
    if (begun) return;
    begun = true;
    for (const char* name :
         {"run.toml", "summary.json", "trace.h5", "trace.part.h5", "rasters.h5", "rasters.part.h5",
          "frames.xyz", "frames.xyz.gz", "frames.ase.xyz", "frames.dump.gz", "curves.csv"})
      fs::remove(path(name));
    remove_vtk(path("frames"));
    write_text(path(kBallast), "");
    const uint64_t bytes = std::min(options.rest, kMost) + kBesideTrace;
    if (const int error = reserve(path(kBallast), 0, bytes)) {
      fs::remove(path(kBallast));
      throw InputError(fmt::format("cannot write into {}: {}", options.directory, std::strerror(error)),
                       fmt::format("hashes, curves and summary alone may take {:.3g} MB",
                                   1e-6 * static_cast<double>(bytes)));
    }
    write_state("running");
    write_text(path("plan.txt"), plan_text(loaded));
    trace.writer.emplace(path("trace.h5"), path("trace.part.h5"), true, &head);
    rasters.writer.emplace(path("rasters.h5"), path("rasters.part.h5"),
                           Rasters{loaded.scene.title, strain_axis(loaded.scene), 2 * style.radius, {}, {}},
                           options.raster);
    if (wants("vtp")) vtk.writer.emplace(path("frames"), style);
    if (wants("xyz")) xyz.writer.emplace(path("frames.xyz"), style);
    if (wants("xyz.gz")) packed_xyz.writer.emplace(path("frames.xyz.gz"), style, XyzForm{.packed = true});
    if (wants("ase")) ase.writer.emplace(path("frames.ase.xyz"), style, XyzForm{.ase = true});
    if (wants("lammps")) lammps.writer.emplace(path("frames.dump.gz"), style);
  }

  void write_state(const std::string& state) {
    options.record.state = state;
    write_record(options.directory, options.record);
  }

  // Remembers what goes wrong, and tells it once: the run is not to end for it.
  bool attempt(const std::function<void()>& write) {
    try {
      write();
      return true;
    } catch (const InputError& error) {
      if (first_error.empty()) {
        first_error = parts_of(error).message;
        fmt::print(stderr, "warning: {}; the run goes on\n", first_error);
      }
      return false;
    }
  }
  template <typename Writer, typename Kept>
  void add(Output<Writer>& output, const Kept& frame) {
    if (output.writer && attempt([&] { output.writer->add(frame); })) ++output.frames;
  }

  void draw(const Frame& frame, const State* state) {
    add(rasters, frame);
    add(vtk, frame);
    add(xyz, frame);
    add(packed_xyz, frame);
    add(ase, frame);
    add(lammps, frame);
    if (options.see) options.see(frame, state);
    ++frames;
  }

  template <typename Writer>
  void tell(std::string& text, const Output<Writer>& output, bool wanted) const {
    if (wanted) text += fmt::format("{}{} has {}", text.empty() ? "" : ", ", output.name, output.frames);
  }

  static constexpr const char* kBallast = ".reserved";

  RecorderOptions options;
  const Loaded& loaded;
  DirectoryLock lock;
  FrameStyle style;
  FrameMaker maker;
  TraceHead head;
  bool begun = false, states = false;  // states: the trace holds frames
  uint64_t frames = 0;
  std::string first_error;
  std::vector<std::string> missing;
  Output<TraceWriter> trace{"trace.h5"};
  Output<RasterWriter> rasters{"rasters.h5"};
  Output<VtkWriter> vtk{"frames.pvd"};
  Output<XyzWriter> xyz{"frames.xyz"}, packed_xyz{"frames.xyz.gz"}, ase{"frames.ase.xyz"};
  Output<LammpsWriter> lammps{"frames.dump.gz"};
};

Recorder::Recorder(RecorderOptions options, const Loaded& loaded)
    : impl_(std::make_unique<Impl>(std::move(options), loaded)) {}

Recorder::~Recorder() {
  if (impl_->trace.writer) impl_->trace.writer->leave();
  if (impl_->rasters.writer) impl_->rasters.writer->leave();
  unlink(impl_->path(Impl::kBallast).c_str());
}

void Recorder::keep(const State& state) {
  Impl& to = *impl_;
  to.begin();
  if (!to.options.no_states) to.states = true, to.add(to.trace, state);
  to.draw(to.maker.make(state), &state);
}

void Recorder::keep(const RealFrame& frame) {
  Impl& to = *impl_;
  to.begin();
  if (!to.options.no_states) to.states = true, to.add(to.trace, frame);
  to.draw(to.maker.make(frame), nullptr);
}

void Recorder::finish(const Trace& trace, const Items& summary, const std::string& state) {
  Impl& to = *impl_;
  to.begin();
  fs::remove(to.path(Impl::kBallast));
  const auto whole = [&](const char* name, const std::function<void()>& write) {
    if (!to.attempt(write)) to.missing.emplace_back(name);
  };
  if (to.rasters.frames > 0)
    whole("rasters.h5", [&] {
      to.rasters.writer->finish();
      to.rasters.writer.reset();
    });
  whole("trace.h5", [&] {
    to.trace.writer->finish(trace);
    to.trace.writer.reset();
  });
  to.vtk.writer.reset();
  to.xyz.writer.reset();
  to.packed_xyz.writer.reset();
  to.ase.writer.reset();
  to.lammps.writer.reset();
  if (to.options.csv)
    whole("curves.csv", [&] { write_text(to.path("curves.csv"), csv_of(to.loaded.scene, trace.curves)); });
  whole("summary.json", [&] { write_text(to.path("summary.json"), summary.json()); });
  to.options.record.reached = trace.reached.has_value();
  whole("run.toml", [&] { to.write_state(to.first_error.empty() ? state : "incomplete"); });
}

std::string Recorder::trouble() const {
  const Impl& of = *impl_;
  if (of.first_error.empty()) return {};
  std::string text, missing;
  of.tell(text, of.trace, of.states);
  of.tell(text, of.rasters, true);
  of.tell(text, of.vtk, of.wants("vtp"));
  of.tell(text, of.xyz, of.wants("xyz"));
  of.tell(text, of.packed_xyz, of.wants("xyz.gz"));
  of.tell(text, of.ase, of.wants("ase"));
  of.tell(text, of.lammps, of.wants("lammps"));
  for (const std::string& name : of.missing) missing += fmt::format("; {} is missing", name);
  return fmt::format("{}; of {} frames {}{}", of.first_error, of.frames, text, missing);
}

}  // namespace cuboct
