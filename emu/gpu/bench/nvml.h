// SPDX-License-Identifier: MIT
// The few functions of NVIDIA's management library that an energy needs. The library comes with the driver,
// not with the toolkit: it is opened at run time, and its functions are declared here as its manual gives
// them (NVIDIA, "NVML API Reference Guide").
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "emu/gpu/device/opened_library.h"

namespace cuboct::gpu {

inline constexpr char kNvmlLibrary[] = "libnvidia-ml.so.1";

// One line: what could not be done, and NVML's own word for it.
class NvmlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Calls are safe from several threads.
class Nvml {
 public:
  using Board = struct nvmlDevice_st*;

  // Throws NvmlError where the library, one of its functions or a driver is not there.
  explicit Nvml(const std::string& library = kNvmlLibrary);
  ~Nvml();
  Nvml(const Nvml&) = delete;
  Nvml& operator=(const Nvml&) = delete;

  std::string driver() const;  // "580.65.06"
  // By PCI bus id, "0000:1b:00.0". Throws NvmlError.
  Board board(const std::string& bus) const;
  std::string name(Board board) const;

  // mJ of the whole board since the driver was loaded; nothing where the board has no such counter.
  std::optional<uint64_t> energy(Board board) const;
  // mW of the whole board: since Ampere (but GA100) a mean over the second before, else the moment's.
  std::optional<uint32_t> power(Board board) const;
  std::optional<uint32_t> sm_clock(Board board) const;  // MHz, the moment's; nothing on any error

 private:
  void check(int answer, const char* what) const;

  OpenedLibrary<NvmlError> library_;
  struct Functions {
    int (*init)() = nullptr;
    int (*shutdown)() = nullptr;
    const char* (*error)(int) = nullptr;
    int (*driver)(char*, unsigned) = nullptr;
    int (*by_bus)(const char*, Board*) = nullptr;
    int (*name)(Board, char*, unsigned) = nullptr;
    int (*energy)(Board, unsigned long long*) = nullptr;
    int (*power)(Board, unsigned*) = nullptr;
    int (*clock)(Board, int, unsigned*) = nullptr;
  } call_;
};

}  // namespace cuboct::gpu
