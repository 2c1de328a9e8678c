// SPDX-License-Identifier: MIT
// What a trace needs of HDF5: files, groups, attributes and arrays that close themselves and complain in the
// words of the file at hand.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <unistd.h>

#include "model/base/error.h"
#include "model/base/output.h"

namespace cuboct::hdf5 {

// To be called before the library's first use. Errors are ours to tell. The library's work at the program's
// exit is to close what is open: files that were abandoned, which ends in a segmentation fault; all others
// are closed by then.
inline void start() {
  static const bool once = (H5dont_atexit(), H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), true);
  static_cast<void>(once);
}

// What the system said to the library's last call, "" where it was not the system that failed it.
inline std::string system_error() {
  std::string_view said;
  const auto look = [](unsigned, const H5E_error2_t* entry, void* to) -> herr_t {
    constexpr std::string_view kBefore = "error message = '";
    const std::string_view text = entry->desc == nullptr ? "" : entry->desc;
    if (const size_t at = text.find(kBefore); at != text.npos) {
      const std::string_view from = text.substr(at + kBefore.size());
      *static_cast<std::string_view*>(to) = from.substr(0, from.find('\''));
    }
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look, &said);
  return std::string(said);
}

// Whether a call failed that leaves a file broken, and what the system said.
struct Broken {
  bool is = false;
  std::string why;
  void take() noexcept {
    try {
      if (!is) why = system_error();
    } catch (const std::bad_alloc&) {
    }
    is = true;
  }
};

// An HDF5 identifier that closes itself; a call that failed throws the error of the file at hand.
class Handle {
 public:
  // `broken`: of the file that it belongs to (Writer). Closing writes, and tells there that it could not; the
  // identifiers of a broken file stay open.
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& error, Broken* broken = nullptr)
      : id_(id), close_(close), broken_(broken) {
    if (id < 0) throw InputError(error);
  }
  ~Handle() {
    if (id_ >= 0 && !(broken_ && broken_->is) && close_(id_) < 0 && broken_) broken_->take();
  }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_), broken_(other.broken_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }
  herr_t close() { return close_(std::exchange(id_, -1)); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
  Broken* broken_;
};

// `file`: as it lies there, little-endian on every machine: same trace, same bytes.
template <typename T>
hid_t type_of(bool file) {
  if constexpr (std::is_same_v<T, uint64_t>) return file ? H5T_STD_U64LE : H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<T, int64_t>) return file ? H5T_STD_I64LE : H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, uint32_t>) return file ? H5T_STD_U32LE : H5T_NATIVE_UINT32;
  if constexpr (std::is_same_v<T, int32_t>) return file ? H5T_STD_I32LE : H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, uint8_t>) return file ? H5T_STD_U8LE : H5T_NATIVE_UINT8;
  if constexpr (std::is_same_v<T, double>) return file ? H5T_IEEE_F64LE : H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, float>) return file ? H5T_IEEE_F32LE : H5T_NATIVE_FLOAT;
}
template <typename T>
hid_t type_in_memory() {
  return type_of<T>(false);
}
template <typename T>
hid_t type_in_file() {
  return type_of<T>(true);
}

using Shape = std::vector<hsize_t>;

// The block of a dataset that begins at `start`, and the memory for it.
struct Slab {
  Slab(hid_t data, const Shape& start, const Shape& shape, const std::string& error)
      : file(H5Dget_space(data), H5Sclose, error),
        memory(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, error) {
    if (H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, shape.data(), nullptr) < 0)
      throw InputError(error);
  }
  // Rows first ... first + size - 1.
  Slab(hid_t data, const Shape& shape, hsize_t first, hsize_t size, const std::string& error)
      : Slab(data, first_row(shape.size(), first), rows(shape, size), error) {}
  Handle file, memory;

 private:
  static Shape first_row(size_t axes, hsize_t first) {
    Shape start(axes, 0);
    start[0] = first;
    return start;
  }
  static Shape rows(Shape shape, hsize_t size) {
    shape[0] = size;
    return shape;
  }
};

// What was written up to the last flush() is in the file if the program dies. A call of the library that
// fails leaves the file broken: HDF5 cannot go on with it, nor close it, so it is abandoned. reserve()
// prevents that where the disk is full.
class Writer {
 public:
  // `packed`: datasets are compressed.
  Writer(const std::string& temporary, const std::string& path, bool packed = true)
      : temporary_(temporary),
        error_(fmt::format("cannot write {}: ", path)),
        packed_(packed),
        file_(create(temporary)) {}
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  hid_t root() const { return file_; }
  bool packed() const { return packed_; }

  // Takes so many bytes of the disk for what comes next. Throws InputError where there are not as many, and
  // leaves the file as it was.
  void reserve(uint64_t bytes) const {
    hsize_t end = 0;
    check(H5Fget_filesize(file_, &end), "size");
    if (const int error = cuboct::reserve(temporary_, end, bytes))
      throw InputError(error_ + std::strerror(error));
  }

  void flush() const { check(H5Fflush(file_, H5F_SCOPE_LOCAL), "flush"); }

  Handle group(hid_t where, const std::string& name) const {
    Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_obj_track_times(properties, false), name);
    return handle(H5Gcreate2(where, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose,
                  "group '" + name + "'");
  }

  void text(hid_t where, const std::string& name, const std::string& value) const {
    Handle type = string_type(value.size());
    Handle space(H5Screate(H5S_SCALAR), H5Sclose, error_ + name);
    const Handle attribute = handle(H5Acreate2(where, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                                    H5Aclose, "attribute '" + name + "'");
    check(H5Awrite(attribute, type, value.empty() ? "" : value.c_str()), name);
  }

  template <typename T>
  void number(hid_t where, const std::string& name, T value) const {
    attribute(where, name, Handle(H5Screate(H5S_SCALAR), H5Sclose, error_ + name), &value);
  }

  // A short list as an attribute.
  template <typename T>
  void numbers(hid_t where, const std::string& name, const std::vector<T>& values) const {
    const hsize_t count = values.size();
    attribute(where, name, Handle(H5Screate_simple(1, &count, nullptr), H5Sclose, error_ + name),
              values.data());
  }

  // `what` says the meaning of the rows and columns, `unit` the unit of a value.
  template <typename T>
  void array(hid_t where, const std::string& name, const Shape& shape, const std::vector<T>& values,
             const std::string& unit, const std::string& what) const {
    write(where, name, shape, type_in_file<T>(), type_in_memory<T>(), values.data(), unit, what);
  }

  // A dataset whose first axis grows by write_block, in chunks of this shape. `shape[0]` is 0.
  template <typename T>
  Handle growing(hid_t where, const std::string& name, const Shape& shape, const Shape& chunk, bool packed,
                 const std::string& unit, const std::string& what) const {
    Shape most = shape;
    most[0] = H5S_UNLIMITED;
    return dataset(where, name, shape, most, chunk, packed, type_in_file<T>(), unit, what);
  }

  void extend(const Handle& data, const std::string& name, const Shape& extent) const {
    check(H5Dset_extent(data, extent.data()), name);
  }

  // Writes a block of a growing dataset, which has this extent then.
  template <typename T>
  void write_block(const Handle& data, const std::string& name, const Shape& extent, const Shape& start,
                   const Shape& shape, const T* values) const {
    extend(data, name, extent);
    const Slab slab(data, start, shape, error_ + name);
    check(H5Dwrite(data, type_in_memory<T>(), slab.memory, slab.file, H5P_DEFAULT, values), name);
  }

  void names(hid_t where, const std::string& name, const std::vector<std::string>& values) const {
    size_t width = 1;
    for (const std::string& value : values) width = std::max(width, value.size());
    std::string flat(width * values.size(), '\0');
    for (size_t i = 0; i < values.size(); ++i) values[i].copy(&flat[i * width], width);
    Handle type = string_type(width);
    write(where, name, {values.size()}, type, type, flat.data(), "", "name");
  }

  // Closing writes the last blocks: a full disk shows here. What was reserved in vain goes back.
  void close() {
    flush();
    hsize_t end = 0;
    check(H5Fget_filesize(file_, &end), "size");
    check(file_.close(), "close");
    if (truncate(temporary_.c_str(), static_cast<off_t>(end)) != 0)
      throw InputError(error_ + std::strerror(errno));
  }

 private:
  template <typename T>
  void attribute(hid_t where, const std::string& name, const Handle& space, const T* values) const {
    const Handle attribute =
        handle(H5Acreate2(where, name.c_str(), type_in_file<T>(), space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
               "attribute '" + name + "'");
    check(H5Awrite(attribute, type_in_memory<T>(), values), name);
  }

  Handle handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) const {
    if (id < 0) broken_.take();
    return {id, close, error_ + (broken_.why.empty() ? what : broken_.why), &broken_};
  }

  Handle create(const std::string& temporary) const {
    start();
    Handle properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_obj_track_times(properties, false), "file");
    // Nobody opens a temporary file. A lock would outlast its name: a program that another thread starts
    // meanwhile has the descriptor too, and keeps readers away until it ends.
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_file_locking(access, false, true), "file");
    errno = 0;
    const hid_t id = H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, properties, access);
    const int error = errno;
    if (id < 0) discard(temporary);  // it is there where its first bytes could not be written
    return Handle(id, H5Fclose, error_ + std::strerror(error), &broken_);
  }

  Handle string_type(size_t size) const {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose, error_ + "string type");
    check(H5Tset_size(type, std::max<size_t>(size, 1)), "string type");
    check(H5Tset_strpad(type, H5T_STR_NULLPAD), "string type");
    check(H5Tset_cset(type, H5T_CSET_UTF8), "string type");
    return type;
  }

  // Chunks of about 2^15 values along the first axis: large enough to pack well, small enough to read in
  // part.
  static hsize_t chunk_rows(const Shape& shape) {
    hsize_t count = 1;
    for (const hsize_t extent : shape) count *= extent;
    return count > 0 ? std::clamp<hsize_t>((hsize_t{1} << 15) * shape[0] / count, 1, shape[0]) : 0;
  }

  Handle dataset(hid_t where, const std::string& name, const Shape& shape, const Shape& most,
                 const Shape& chunk, bool packed, hid_t in_file, const std::string& unit,
                 const std::string& what) const {
    Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, error_ + "HDF5 property list");
    check(H5Pset_obj_track_times(properties, false), name);
    if (chunk[0] > 0) {
      check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), name);
      if (packed) {
        check(H5Pset_shuffle(properties), name);
        check(H5Pset_deflate(properties, 4), name);
      }
    }
    Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), most.data()), H5Sclose,
                 error_ + name);
    Handle data =
        handle(H5Dcreate2(where, name.c_str(), in_file, space, H5P_DEFAULT, properties, H5P_DEFAULT),
               H5Dclose, "dataset '" + name + "'");
    text(data, "unit", unit);
    text(data, "what", what);
    return data;
  }

  void write(hid_t where, const std::string& name, const Shape& shape, hid_t in_file, hid_t in_memory,
             const void* values, const std::string& unit, const std::string& what) const {
    Shape chunk = shape;
    chunk[0] = chunk_rows(shape);
    const Handle data = dataset(where, name, shape, shape, chunk, packed_, in_file, unit, what);
    if (chunk[0] > 0) check(H5Dwrite(data, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
  }

  void check(herr_t result, const std::string& name) const {
    if (result < 0) broken_.take();
    if (!broken_.is) return;
    throw InputError(broken_.why.empty() ? fmt::format("{}HDF5 failed at '{}'", error_, name)
                                         : error_ + broken_.why);
  }

  std::string temporary_, error_;
  bool packed_;
  mutable Broken broken_;
  Handle file_;
};

// A dataset that grows by rows of `columns` values. Whole chunks go to the file as they fill, the rest in the
// end: so a chunk is written and packed once.
template <typename T>
class Growing {
 public:
  Growing(const Writer& out, hid_t where, std::string name, hsize_t chunk, hsize_t columns,
          const std::string& unit, const std::string& what)
      : out_(out),
        name_(std::move(name)),
        columns_(columns),
        chunk_(chunk),
        data_(out.growing<T>(where, name_, shape(0), shape(chunk), out.packed(), unit, what)) {
    buffer_.reserve(chunk * columns);
  }

  void add(const T* row) {
    buffer_.insert(buffer_.end(), row, row + columns_);
    if (buffer_.size() == chunk_ * columns_) write();
  }
  void finish() {
    if (!buffer_.empty()) write();
  }
  uint64_t chunk_bytes() const { return chunk_ * columns_ * sizeof(T); }

 private:
  Shape shape(hsize_t rows) const { return columns_ == 1 ? Shape{rows} : Shape{rows, columns_}; }
  void write() {
    const hsize_t rows = buffer_.size() / columns_;
    out_.write_block(data_, name_, shape(written_ + rows),
                     columns_ == 1 ? Shape{written_} : Shape{written_, 0}, shape(rows), buffer_.data());
    written_ += rows;
    buffer_.clear();
  }

  const Writer& out_;
  std::string name_;
  hsize_t columns_, chunk_, written_ = 0;
  Handle data_;
  std::vector<T> buffer_;
};

// Reads files of a stranger: what a file says of its own lengths is held against the bytes that it has before
// any memory is taken, and nothing is read from another file.
class Reader {
 public:
  // `kind` of cuboct's files, for errors.
  explicit Reader(const std::string& path, std::string kind = "trace")
      : path_(path), kind_(std::move(kind)), file_(open(path)), bytes_(std::filesystem::file_size(path)) {}

  hid_t root() const { return file_; }
  std::string missing(const std::string& kind, const std::string& name) const {
    return fmt::format("{} is not a cuboct {}: no {} '{}'", path_, kind_, kind, name);
  }

  bool has(hid_t where, const std::string& name) const {
    return H5Lexists(where, name.c_str(), H5P_DEFAULT) > 0;
  }

  bool has_attribute(hid_t where, const std::string& name) const {
    return H5Aexists(where, name.c_str()) > 0;
  }

  Handle group(hid_t where, const std::string& name) const {
    check_link(where, name, "group");
    return Handle(H5Gopen2(where, name.c_str(), H5P_DEFAULT), H5Gclose, missing("group", name));
  }

  std::string text(hid_t where, const std::string& name) const {
    Handle attribute(H5Aopen(where, name.c_str(), H5P_DEFAULT), H5Aclose, missing("attribute", name));
    Handle type(H5Aget_type(attribute), H5Tclose, missing("attribute", name));
    Handle space(H5Aget_space(attribute), H5Sclose, missing("attribute", name));
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
        H5Sget_simple_extent_npoints(space) != 1 || H5Tget_size(type) > bytes_)
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
      throw InputError(fmt::format("{} is not a cuboct {}: the shape of '{}' is wrong", path_, kind_, name));
    size_t count = 1;
    for (const hsize_t extent : shape) count *= extent;  // dataset() has seen that it fits
    std::vector<T> values(count);
    if (count > 0 && H5Dread(data, type_in_memory<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      throw InputError(fmt::format("cannot read '{}' of {}", name, path_));
    return values;
  }

  // The shape of a dataset of which no more than blocks are read.
  Shape extent(hid_t where, const std::string& name) const { return shape_of(opened(where, name), name); }
  // InputError where the file cannot hold so many values of it. What was never written takes no bytes: some
  // are let pass whatever the file holds.
  void check_stored(hid_t where, const std::string& name, const Shape& shape, hsize_t spare = 1 << 24) const {
    check_stored(opened(where, name), name, shape, spare);
  }

  // The block that begins at `start`; check_stored() before, where the file is not to be trusted.
  template <typename T>
  std::vector<T> block(hid_t where, const std::string& name, const Shape& start, const Shape& shape) const {
    const Handle data = opened(where, name);
    const Shape found = shape_of(data, name);
    bool inside = found.size() == shape.size();
    size_t count = 1;
    for (size_t axis = 0; inside && axis < shape.size(); ++axis) {
      inside = start[axis] <= found[axis] && shape[axis] <= found[axis] - start[axis];
      count *= shape[axis];
    }
    same_length(inside, "the fields");
    std::vector<T> values(count);
    const std::string error = fmt::format("cannot read '{}' of {}", name, path_);
    const Slab slab(data, start, shape, error);
    if (count > 0 &&
        H5Dread(data, type_in_memory<T>(), slab.memory, slab.file, H5P_DEFAULT, values.data()) < 0)
      throw InputError(error);
    return values;
  }

  Shape shape(hid_t where, const std::string& name) const { return shape_of(dataset(where, name), name); }
  hsize_t length(hid_t where, const std::string& name) const { return shape(where, name)[0]; }

  // Rows first ... first + count - 1 in pieces: next(values) for one row of `columns` values after another.
  template <typename T, typename Next>
  void rows(hid_t where, const std::string& name, hsize_t first, hsize_t count, hsize_t columns,
            Next next) const {
    const Handle data = dataset(where, name);
    const Shape found = shape_of(data, name);
    if (found.size() != (columns == 1 ? 1 : 2) || (columns > 1 && found[1] != columns))
      throw InputError(fmt::format("{} is not a cuboct {}: the shape of '{}' is wrong", path_, kind_, name));
    same_length(found[0] >= first + count, "the frames' fields");
    const hsize_t block = std::min<hsize_t>(count, 1 << 15);
    std::vector<T> values(block * columns);
    for (hsize_t done = 0; done < count; done += block) {
      const hsize_t size = std::min(block, count - done);
      const std::string error = fmt::format("cannot read '{}' of {}", name, path_);
      const Slab slab(data, found, first + done, size, error);
      if (H5Dread(data, type_in_memory<T>(), slab.memory, slab.file, H5P_DEFAULT, values.data()) < 0)
        throw InputError(error);
      for (hsize_t row = 0; row < size; ++row) next(&values[row * columns]);
    }
  }

  std::vector<std::string> names(hid_t where, const std::string& name) const {
    Handle data = dataset(where, name);
    const Shape shape = shape_of(data, name);
    Handle type(H5Dget_type(data), H5Tclose, missing("dataset", name));
    if (shape.size() != 1 || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
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
    if (!same)
      throw InputError(fmt::format("{} is not a cuboct {}: {} disagree in length", path_, kind_, what));
  }
  const std::string& path() const { return path_; }

 private:
  static Handle open(const std::string& path) {
    start();
    std::error_code none;
    const bool special = std::filesystem::exists(path, none) && !std::filesystem::is_regular_file(path, none);
    std::FILE* file = special ? nullptr : std::fopen(path.c_str(), "rb");  // a pipe would wait for a writer
    if (!file)
      throw InputError(
          fmt::format("cannot read {}: {}", path, special ? "it is no file" : std::strerror(errno)));
    std::fclose(file);
    H5PLset_loading_state(0);  // a file may ask for a filter, and a filter is code
    const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (id < 0 && H5Fis_hdf5(path.c_str()) > 0)
      throw InputError(fmt::format("{} is damaged: it begins as an HDF5 file, and HDF5 cannot open it", path),
                       "it was cut short or written over; the command that made it makes it again");
    return Handle(id, H5Fclose, fmt::format("{} is not an HDF5 file", path));
  }
  Handle opened(hid_t where, const std::string& name) const {
    check_link(where, name, "dataset");
    Handle data(H5Dopen2(where, name.c_str(), H5P_DEFAULT), H5Dclose, missing("dataset", name));
    const Handle properties(H5Dget_create_plist(data), H5Pclose, missing("dataset", name));
    if (H5Pget_layout(properties) == H5D_VIRTUAL || H5Pget_external_count(properties) != 0)
      throw InputError(fmt::format("{}: '{}' takes its values from another file", path_, name),
                       "a trace of cuboct holds all of its values");
    for (int k = 0, count = H5Pget_nfilters(properties); k < count; ++k)
      if (const H5Z_filter_t filter = filter_at(properties, k);
          filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE)
        throw InputError(fmt::format("{}: '{}' is packed by filter {} of HDF5", path_, name, filter),
                         "a trace of cuboct is shuffled (2) and deflated (1): h5repack can make it so");
    return data;
  }
  Handle dataset(hid_t where, const std::string& name) const {
    Handle data = opened(where, name);
    check_stored(data, name, shape_of(data, name), 0);
    return data;
  }
  void check_stored(const Handle& data, const std::string& name, const Shape& shape, hsize_t spare) const {
    // Deflate packs 1032 bytes into one at most, and a value that was never written takes none.
    constexpr hsize_t kMostPacked = 1100;
    const hsize_t stored = std::min<hsize_t>(H5Dget_storage_size(data), bytes_) * kMostPacked;
    const Handle type(H5Dget_type(data), H5Tclose, missing("dataset", name));
    hsize_t left = stored / std::max<size_t>(H5Tget_size(type), 1) + spare;
    const bool empty = std::find(shape.begin(), shape.end(), 0) != shape.end();
    for (const hsize_t extent : shape)
      if (!empty) left /= extent;
    if (!empty && left == 0)
      throw InputError(
          fmt::format("{} is damaged: '{}' says that it has {} values, and the file does not hold them",
                      path_, name, fmt::join(shape, " x ")));
  }
  static H5Z_filter_t filter_at(hid_t properties, int k) {
    size_t values = 0;
    unsigned flags = 0, can = 0;
    return H5Pget_filter2(properties, static_cast<unsigned>(k), &flags, &values, nullptr, 0, nullptr, &can);
  }
  void check_link(hid_t where, const std::string& name, const std::string& kind) const {
    H5L_info_t info;
    if (H5Lget_info(where, name.c_str(), &info, H5P_DEFAULT) < 0 || info.type != H5L_TYPE_HARD)
      throw InputError(missing(kind, name));
  }
  Shape shape_of(hid_t data, const std::string& name) const {
    Handle space(H5Dget_space(data), H5Sclose, missing("dataset", name));
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1) throw InputError(missing("array", name));
    Shape shape(rank);
    H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    return shape;
  }

  std::string path_, kind_;
  Handle file_;
  hsize_t bytes_ = 0;  // of the file
};

}  // namespace cuboct::hdf5
