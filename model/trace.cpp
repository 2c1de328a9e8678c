// SPDX-License-Identifier: MIT
#include "model/trace.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "model/output.h"

namespace cuboct {
namespace {

constexpr char kFormat[] = "cuboct trace";
constexpr uint32_t kVersion = 1;

// An HDF5 identifier that closes itself; a call that failed throws the error of the file at hand.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& error) : id_(id), close_(close) {
    if (id < 0) throw InputError(error);
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }
  herr_t close() { return close_(std::exchange(id_, -1)); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <typename T>
hid_t type_in_memory();
template <>
hid_t type_in_memory<uint64_t>() {
  return H5T_NATIVE_UINT64;
}
template <>
hid_t type_in_memory<int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t type_in_memory<uint32_t>() {
  return H5T_NATIVE_UINT32;
}
template <>
hid_t type_in_memory<uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
hid_t type_in_memory<double>() {
  return H5T_NATIVE_DOUBLE;
}

// Little-endian on every machine: same trace, same bytes.
template <typename T>
hid_t type_in_file();
template <>
hid_t type_in_file<uint64_t>() {
  return H5T_STD_U64LE;
}
template <>
hid_t type_in_file<int64_t>() {
  return H5T_STD_I64LE;
}
template <>
hid_t type_in_file<uint32_t>() {
  return H5T_STD_U32LE;
}
template <>
hid_t type_in_file<uint8_t>() {
  return H5T_STD_U8LE;
}
template <>
hid_t type_in_file<double>() {
  return H5T_IEEE_F64LE;
}

using Shape = std::vector<hsize_t>;

class Writer {
 public:
  Writer(const std::string& temporary, const std::string& path)
      : error_(fmt::format("cannot write {}: ", path)), file_(create(temporary)) {}

  hid_t root() const { return file_; }

  Handle group(hid_t where, const std::string& name) const {
    Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_obj_track_times(properties, false), name);
    return Handle(H5Gcreate2(where, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose,
                  error_ + "group '" + name + "'");
  }

  void text(hid_t where, const std::string& name, const std::string& value) const {
    Handle type = string_type(value.size());
    Handle space(H5Screate(H5S_SCALAR), H5Sclose, error_ + name);
    Handle attribute(H5Acreate2(where, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                     error_ + "attribute '" + name + "'");
    check(H5Awrite(attribute, type, value.empty() ? "" : value.c_str()), name);
  }

  template <typename T>
  void number(hid_t where, const std::string& name, T value) const {
    Handle space(H5Screate(H5S_SCALAR), H5Sclose, error_ + name);
    Handle attribute(H5Acreate2(where, name.c_str(), type_in_file<T>(), space, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose, error_ + "attribute '" + name + "'");
    check(H5Awrite(attribute, type_in_memory<T>(), &value), name);
  }

  // `what` says the meaning of the rows and columns, `unit` the unit of a value.
  template <typename T>
  void array(hid_t where, const std::string& name, const Shape& shape, const std::vector<T>& values,
             const std::string& unit, const std::string& what) const {
    write(where, name, shape, type_in_file<T>(), type_in_memory<T>(), values.data(), unit, what);
  }

  void names(hid_t where, const std::string& name, const std::vector<std::string>& values) const {
    size_t width = 1;
    for (const std::string& value : values) width = std::max(width, value.size());
    std::string flat(width * values.size(), '\0');
    for (size_t i = 0; i < values.size(); ++i) values[i].copy(&flat[i * width], width);
    Handle type = string_type(width);
    write(where, name, {values.size()}, type, type, flat.data(), "", "name");
  }

  // Closing writes the last blocks: a full disk shows here.
  void close() { check(file_.close(), "close"); }

 private:
  Handle create(const std::string& temporary) const {
    Handle properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_obj_track_times(properties, false), "file");
    errno = 0;
    const hid_t id = H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, properties, H5P_DEFAULT);
    return Handle(id, H5Fclose, error_ + std::strerror(errno));
  }

  Handle string_type(size_t size) const {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose, error_ + "string type");
    check(H5Tset_size(type, std::max<size_t>(size, 1)), "string type");
    check(H5Tset_strpad(type, H5T_STR_NULLPAD), "string type");
    check(H5Tset_cset(type, H5T_CSET_UTF8), "string type");
    return type;
  }

  void write(hid_t where, const std::string& name, const Shape& shape, hid_t in_file, hid_t in_memory,
             const void* values, const std::string& unit, const std::string& what) const {
    Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_obj_track_times(properties, false), name);
    hsize_t count = 1;
    for (const hsize_t extent : shape) count *= extent;
    if (count > 0) {
      // Chunks of about 2^15 values along the first axis: large enough to pack well, small enough to read in
      // part.
      Shape chunk = shape;
      chunk[0] = std::clamp<hsize_t>((hsize_t{1} << 15) * shape[0] / count, 1, shape[0]);
      check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), name);
      check(H5Pset_shuffle(properties), name);
      check(H5Pset_deflate(properties, 4), name);
    }
    Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
                 error_ + name);
    Handle data(H5Dcreate2(where, name.c_str(), in_file, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                H5Dclose, error_ + "dataset '" + name + "'");
    if (count > 0) check(H5Dwrite(data, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
    text(data, "unit", unit);
    text(data, "what", what);
  }

  void check(herr_t result, const std::string& name) const {
    if (result < 0) throw InputError(fmt::format("{}HDF5 failed at '{}'", error_, name));
  }

  std::string error_;
  Handle file_;
};

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), file_(open(path)) {}

  hid_t root() const { return file_; }
  std::string missing(const std::string& kind, const std::string& name) const {
    return fmt::format("{} is not a cuboct trace: no {} '{}'", path_, kind, name);
  }

  bool has(hid_t where, const std::string& name) const {
    return H5Lexists(where, name.c_str(), H5P_DEFAULT) > 0;
  }

  bool has_attribute(hid_t where, const std::string& name) const {
    return H5Aexists(where, name.c_str()) > 0;
  }

  Handle group(hid_t where, const std::string& name) const {
    return Handle(H5Gopen2(where, name.c_str(), H5P_DEFAULT), H5Gclose, missing("group", name));
  }

  std::string text(hid_t where, const std::string& name) const {
    Handle attribute(H5Aopen(where, name.c_str(), H5P_DEFAULT), H5Aclose, missing("attribute", name));
    Handle type(H5Aget_type(attribute), H5Tclose, missing("attribute", name));
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
      throw InputError(missing("text attribute", name));
    std::string value(H5Tget_size(type), '\0');
    if (H5Aread(attribute, type, value.data()) < 0) throw InputError(missing("text attribute", name));
    return value.substr(0, value.find('\0'));
  }

  template <typename T>
  T number(hid_t where, const std::string& name) const {
    Handle attribute(H5Aopen(where, name.c_str(), H5P_DEFAULT), H5Aclose, missing("attribute", name));
    Handle space(H5Aget_space(attribute), H5Sclose, missing("attribute", name));
    T value{};
    if (H5Sget_simple_extent_npoints(space) != 1 || H5Aread(attribute, type_in_memory<T>(), &value) < 0)
      throw InputError(missing("number", name));
    return value;
  }

  // All values; the shape must be `columns` behind a first axis of any length.
  template <typename T>
  std::vector<T> array(hid_t where, const std::string& name, const Shape& columns = {}) const {
    Handle data = dataset(where, name);
    const Shape shape = shape_of(data, name);
    if (Shape(shape.begin() + 1, shape.end()) != columns)
      throw InputError(fmt::format("{} is not a cuboct trace: the shape of '{}' is wrong", path_, name));
    size_t count = 1;
    for (const hsize_t extent : shape) count *= extent;
    std::vector<T> values(count);
    if (count > 0 && H5Dread(data, type_in_memory<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      throw InputError(fmt::format("cannot read '{}' of {}", name, path_));
    return values;
  }

  std::vector<std::string> names(hid_t where, const std::string& name) const {
    Handle data = dataset(where, name);
    const Shape shape = shape_of(data, name);
    Handle type(H5Dget_type(data), H5Tclose, missing("dataset", name));
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
      throw InputError(missing("list of names", name));
    const size_t width = H5Tget_size(type);
    std::string flat(width * shape[0], '\0');
    if (shape[0] > 0 && H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, flat.data()) < 0)
      throw InputError(fmt::format("cannot read '{}' of {}", name, path_));
    std::vector<std::string> values(shape[0]);
    for (size_t i = 0; i < values.size(); ++i) {
      values[i] = flat.substr(i * width, width);
      values[i].resize(std::min(values[i].find('\0'), values[i].size()));
    }
    return values;
  }

  void same_length(bool same, const std::string& what) const {
    if (!same) throw InputError(fmt::format("{} is not a cuboct trace: {} disagree in length", path_, what));
  }
  const std::string& path() const { return path_; }

 private:
  static Handle open(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) throw InputError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
    std::fclose(file);
    return Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                  fmt::format("{} is not an HDF5 file", path));
  }
  Handle dataset(hid_t where, const std::string& name) const {
    return Handle(H5Dopen2(where, name.c_str(), H5P_DEFAULT), H5Dclose, missing("dataset", name));
  }
  Shape shape_of(hid_t data, const std::string& name) const {
    Handle space(H5Dget_space(data), H5Sclose, missing("dataset", name));
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1) throw InputError(missing("array", name));
    Shape shape(rank);
    H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    return shape;
  }

  std::string path_;
  Handle file_;
};

void write_frames(const Writer& out, const std::vector<State>& frames) {
  std::vector<uint64_t> step;
  std::vector<int64_t> first{0};  // signed: NumPy makes a float of an unsigned 64-bit number plus 1
  std::vector<uint32_t> id, node;
  std::vector<uint8_t> type;
  std::vector<int64_t> x, v, u;
  for (const State& frame : frames) {
    step.push_back(frame.step);
    for (const Particle& particle : frame.particles) {
      id.push_back(particle.id);
      type.push_back(particle.type);
      node.push_back(particle.node);
      x.insert(x.end(), particle.x.begin(), particle.x.end());
      v.insert(v.end(), particle.v.begin(), particle.v.end());
      u.insert(u.end(), particle.u.begin(), particle.u.end());
    }
    first.push_back(static_cast<int64_t>(id.size()));
  }
  const Handle group = out.group(out.root(), "frames");
  const hsize_t rows = id.size();
  out.array(group, "step", {step.size()}, step, "step", "[frame]");
  out.array(group, "first", {first.size()}, first, "", "[frame]: rows first[k] to first[k+1]-1 are frame k");
  out.array(group, "id", {rows}, id, "", "[row]");
  out.array(group, "type", {rows}, type, "", "[row] index into the rule's types");
  out.array(group, "node", {rows}, node, "", "[row] index into the lattice");
  out.array(group, "x", {rows, 3}, x, "cell edge / 2^P", "[row][axis] offset in the node");
  out.array(group, "v", {rows, 3}, v, "cell edge / step / 2^(P+G)",
            "[row][axis] velocity, half a step earlier");
  out.array(group, "u", {rows, 3}, u, "cell edge / 2^(P+G)", "[row][axis] displacement from the anchor");
}

std::vector<State> read_frames(const Reader& in) {
  const Handle group = in.group(in.root(), "frames");
  const auto step = in.array<uint64_t>(group, "step");
  const auto first = in.array<int64_t>(group, "first");
  const auto id = in.array<uint32_t>(group, "id");
  const auto type = in.array<uint8_t>(group, "type");
  const auto node = in.array<uint32_t>(group, "node");
  const auto x = in.array<int64_t>(group, "x", {3});
  const auto v = in.array<int64_t>(group, "v", {3});
  const auto u = in.array<int64_t>(group, "u", {3});
  in.same_length(first.size() == step.size() + 1 && first.front() == 0 &&
                     first.back() == static_cast<int64_t>(id.size()) &&
                     std::is_sorted(first.begin(), first.end()) && type.size() == id.size() &&
                     node.size() == id.size() && x.size() == 3 * id.size() && v.size() == x.size() &&
                     u.size() == x.size(),
                 "the frames' fields");
  std::vector<State> frames(step.size());
  for (size_t k = 0; k < frames.size(); ++k) {
    frames[k].step = step[k];
    for (auto row = static_cast<size_t>(first[k]); row < static_cast<size_t>(first[k + 1]); ++row) {
      const auto triple = [row](const std::vector<int64_t>& a) {
        return Int3{a[3 * row], a[3 * row + 1], a[3 * row + 2]};
      };
      frames[k].particles.push_back({id[row], type[row], node[row], triple(x), triple(v), triple(u)});
    }
  }
  return frames;
}

void write_curves(const Writer& out, const std::vector<Curve>& curves) {
  const Handle group = out.group(out.root(), "curves");
  uint32_t index = 0;
  for (const Curve& curve : curves) {
    if (curve.name.empty() || curve.name.find('/') != std::string::npos)
      throw InputError(fmt::format(
          "a curve cannot be called '{}' in a trace: a name needs characters, none of them '/'", curve.name));
    const Handle one = out.group(group, curve.name);
    out.number<uint32_t>(one, "index", index++);
    out.array(one, "step", {curve.step.size()}, curve.step, "step", "[sample]");
    out.array(one, "value", {curve.value.size()}, curve.value, curve.unit, "[sample]");
  }
}

std::vector<Curve> read_curves(const Reader& in) {
  const Handle group = in.group(in.root(), "curves");
  H5G_info_t info;
  if (H5Gget_info(group, &info) < 0) throw InputError(in.missing("group", "curves"));
  std::vector<std::pair<uint32_t, Curve>> found;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto name_at = [&](char* text, size_t size) {
      return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
    };
    Curve curve;
    curve.name.resize(std::max<ssize_t>(name_at(nullptr, 0), 0));
    name_at(curve.name.data(), curve.name.size() + 1);
    const Handle one = in.group(group, curve.name);
    curve.step = in.array<uint64_t>(one, "step");
    curve.value = in.array<double>(one, "value");
    const Handle value(H5Dopen2(one, "value", H5P_DEFAULT), H5Dclose, in.missing("dataset", "value"));
    curve.unit = in.text(value, "unit");
    in.same_length(curve.step.size() == curve.value.size(), "a curve's steps and values");
    found.emplace_back(in.number<uint32_t>(one, "index"), std::move(curve));
  }
  std::stable_sort(found.begin(), found.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<Curve> curves;
  for (auto& [index, curve] : found) curves.push_back(std::move(curve));
  return curves;
}

void write_cycles(const Writer& out, const Trace& trace) {
  if (trace.cycles.empty()) return;
  std::vector<uint64_t> flat;
  flat.reserve(2 * trace.cycles.size());
  for (const PhaseSpan& span : trace.cycles) flat.insert(flat.end(), {span.start, span.end});
  const hsize_t row = std::max<hsize_t>(trace.nodes, 1) * kPhases;
  if (trace.cycles.size() % row != 0)
    throw std::logic_error("a trace's cycles are not steps x nodes x phases");
  out.array(
      out.root(), "cycles", {trace.cycles.size() / row, row / kPhases, hsize_t{kPhases}, 2}, flat, "cycle",
      "[step][node][phase][start, end]; phases: exchange_x exchange_y exchange_z force update migrate_x "
      "migrate_y migrate_z");
}

}  // namespace

const char* to_string(Phase phase) {
  switch (phase) {
    case Phase::exchange_x:
      return "exchange_x";
    case Phase::exchange_y:
      return "exchange_y";
    case Phase::exchange_z:
      return "exchange_z";
    case Phase::force:
      return "force";
    case Phase::update:
      return "update";
    case Phase::migrate_x:
      return "migrate_x";
    case Phase::migrate_y:
      return "migrate_y";
    case Phase::migrate_z:
      return "migrate_z";
  }
  return "?";
}

namespace {

// Whether the number of hashes is one that steps and hash_every allow.
bool hashes_fit(const Trace& trace) {
  if (trace.hash_every == 0) return false;
  if (trace.hash_every == 1 || trace.state_hash.empty()) return true;
  const uint64_t whole = trace.steps_done / trace.hash_every + 1;
  const bool rest = trace.steps_done % trace.hash_every != 0;
  return trace.state_hash.size() == whole + rest || (trace.stop && trace.state_hash.size() == whole);
}

}  // namespace

void write_trace(const std::string& path, const Trace& trace) {
  if (!hashes_fit(trace)) throw std::logic_error("a trace's hashes do not fit its steps and hash_every");
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are ours to tell
  check_writable(path);
  write_whole(path, [&](const std::string& temporary) {
    Writer out(temporary, path);
    out.text(out.root(), "format", kFormat);
    out.number<uint32_t>(out.root(), "version", kVersion);
    out.text(out.root(), "engine", trace.engine);
    out.number<uint64_t>(out.root(), "plan_hash", trace.plan_hash);
    out.number<uint64_t>(out.root(), "nodes", trace.nodes);
    out.number<double>(out.root(), "seconds", trace.seconds);
    out.number<uint64_t>(out.root(), "steps", trace.steps());
    out.number<uint64_t>(out.root(), "hash_every", trace.hash_every);
    out.array(out.root(), "state_hash", {trace.state_hash.size()}, trace.state_hash, "",
              trace.hash_every == 1 ? "[step]" : "[step / hash_every], then of the last step");
    write_frames(out, trace.frames);
    write_curves(out, trace.curves);
    write_cycles(out, trace);
    {
      const Handle counters = out.group(out.root(), "counters");
      std::vector<std::string> names;
      std::vector<double> values;
      for (const auto& [name, value] : trace.counters) names.push_back(name), values.push_back(value);
      out.names(counters, "name", names);
      out.array(counters, "value", {values.size()}, values, "", "[counter]");
    }
    if (trace.stop) {
      const Handle stop = out.group(out.root(), "stop");
      out.number<uint8_t>(stop, "fault", static_cast<uint8_t>(trace.stop->fault));
      out.text(stop, "fault_name", to_string(trace.stop->fault));
      out.number<uint64_t>(stop, "step", trace.stop->step);
      out.number<uint32_t>(stop, "node", trace.stop->node);
      out.number<uint32_t>(stop, "particle", trace.stop->particle);
      out.number<int64_t>(stop, "number", trace.stop->number);
      out.text(stop, "text", trace.stop->text);
    }
    out.close();
  });
}

Trace read_trace(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Reader in(path);
  if (in.text(in.root(), "format") != kFormat) throw InputError(in.missing("attribute", "format"));
  const auto version = in.number<uint32_t>(in.root(), "version");
  if (version != kVersion)
    throw InputError(
        fmt::format("{} is a trace of version {}; this program reads version {}", path, version, kVersion));
  Trace trace;
  trace.engine = in.text(in.root(), "engine");
  trace.plan_hash = in.number<uint64_t>(in.root(), "plan_hash");
  trace.nodes = in.number<uint64_t>(in.root(), "nodes");
  trace.seconds = in.number<double>(in.root(), "seconds");
  trace.state_hash = in.array<uint64_t>(in.root(), "state_hash");
  if (in.has_attribute(in.root(), "hash_every")) {
    trace.hash_every = in.number<uint64_t>(in.root(), "hash_every");
    const auto steps = in.number<uint64_t>(in.root(), "steps");
    if (trace.hash_every != 1 || trace.state_hash.empty()) trace.steps_done = steps;
    in.same_length(trace.hash_every > 0 && trace.steps() == steps, "steps and state hashes");
  }  // else the file is from before hashes could be left out
  trace.frames = read_frames(in);
  trace.curves = read_curves(in);
  if (in.has(in.root(), "cycles")) {
    const auto flat = in.array<uint64_t>(in.root(), "cycles", {trace.nodes, hsize_t{kPhases}, 2});
    for (size_t i = 0; i < flat.size(); i += 2) trace.cycles.push_back({flat[i], flat[i + 1]});
  }
  const Handle counters = in.group(in.root(), "counters");
  const auto names = in.names(counters, "name");
  const auto values = in.array<double>(counters, "value");
  in.same_length(names.size() == values.size(), "the counters' names and values");
  for (size_t i = 0; i < names.size(); ++i) trace.counters.emplace_back(names[i], values[i]);
  if (in.has(in.root(), "stop")) {
    const Handle stop = in.group(in.root(), "stop");
    trace.stop = StopReason{static_cast<Fault>(in.number<uint8_t>(stop, "fault")),
                            in.number<uint64_t>(stop, "step"),
                            in.number<uint32_t>(stop, "node"),
                            in.number<uint32_t>(stop, "particle"),
                            in.number<int64_t>(stop, "number"),
                            in.text(stop, "text")};
  }
  in.same_length(hashes_fit(trace), "steps and state hashes");
  return trace;
}

}  // namespace cuboct
