// SPDX-License-Identifier: MIT
// Files of a stranger, whatever is in them: those that a user names, or that lie in a directory that a user
// names. HDF5, which some files crash, reads them in a program of its own (model/base/guarded_reader.h), by
// the functions of the same names without `guarded`: these are for what this very run's programs wrote.
#pragma once

#include <string>

#include "model/trace/left_state.h"
#include "model/trace/raster.h"
#include "model/trace/trace.h"

namespace cuboct {

// As read_trace, read_left_state and read_rasters. InputError too where reading takes more memory than is
// free, or longer than any honest file of its size.
Trace guarded_trace(const std::string& path);
LeftState guarded_left_state(const std::string& path);
Rasters guarded_rasters(const std::string& path);

// The program, and the words by which it is told what to read.
inline constexpr const char* kTraceReader = "cuboct-read-trace";
inline constexpr const char* kReadTrace = "trace";
inline constexpr const char* kReadLeftState = "state";
inline constexpr const char* kReadRasters = "rasters";

}  // namespace cuboct
