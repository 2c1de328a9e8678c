// SPDX-License-Identifier: MIT
// CUDA's compiler as a library, for programs that are known when an engine runs. It comes with the toolkit,
// or alone with the package nvidia-cuda-nvrtc: it is opened at run time, and its functions are declared here
// as its manual gives them (NVIDIA, "NVRTC").
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "emu/gpu/device/opened_library.h"

namespace cuboct::gpu {

// In words that end a sentence: why nothing was compiled.
class NvrtcError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Nvrtc {
 public:
  // By names in their order; throws NvrtcError where none is there, or one lacks a function.
  explicit Nvrtc(const std::vector<std::string>& libraries = {
                     "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so", "/usr/local/cuda/lib64/libnvrtc.so"});

  std::string version() const;  // "13.0"
  // Machine code of `source`, which may include `headers` (name and text), for an architecture ("sm_90").
  // Throws NvrtcError with the compiler's first error.
  std::string compiled(const std::string& source,
                       const std::vector<std::pair<std::string, std::string>>& headers,
                       const std::string& architecture) const;

 private:
  using Program = struct _nvrtcProgram*;
  void check(int answer, const char* what) const;

  OpenedLibrary<NvrtcError> library_;
  struct Functions {
    int (*version)(int*, int*) = nullptr;
    const char* (*error)(int) = nullptr;
    int (*create)(Program*, const char*, const char*, int, const char* const*, const char* const*) = nullptr;
    int (*destroy)(Program*) = nullptr;
    int (*compile)(Program, int, const char* const*) = nullptr;
    int (*log_size)(Program, size_t*) = nullptr;
    int (*log)(Program, char*) = nullptr;
    int (*code_size)(Program, size_t*) = nullptr;
    int (*code)(Program, char*) = nullptr;
  } call_;
};

// The path of the file with the machine code of a source that includes round_headers(), kept in `directory`
// under a name that is a hash of all that it is made of: what is there is not compiled again. Throws
// NvrtcError, also where the directory cannot be written.
std::string compiled_file(const std::string& source, const std::string& architecture,
                          const std::string& directory);

}  // namespace cuboct::gpu
