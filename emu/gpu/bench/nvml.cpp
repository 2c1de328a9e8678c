// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/nvml.h"

#include <fmt/format.h>

namespace cuboct::gpu {
namespace {

constexpr int kSuccess = 0, kNotSupported = 3;  // of nvmlReturn_t
constexpr int kSmClock = 1;                     // of nvmlClockType_t
constexpr unsigned kNameSize = 96;              // NVML_DEVICE_NAME_V2_BUFFER_SIZE
constexpr unsigned kDriverSize = 80;            // NVML_SYSTEM_DRIVER_VERSION_BUFFER_SIZE

}  // namespace

Nvml::Nvml(const std::string& library) : library_("NVML", {library}) {
  library_.bind(call_.init, "nvmlInit_v2");
  library_.bind(call_.shutdown, "nvmlShutdown");
  library_.bind(call_.error, "nvmlErrorString");
  library_.bind(call_.driver, "nvmlSystemGetDriverVersion");
  library_.bind(call_.by_bus, "nvmlDeviceGetHandleByPciBusId_v2");
  library_.bind(call_.name, "nvmlDeviceGetName");
  library_.bind(call_.energy, "nvmlDeviceGetTotalEnergyConsumption");
  library_.bind(call_.power, "nvmlDeviceGetPowerUsage");
  library_.bind(call_.clock, "nvmlDeviceGetClockInfo");
  if (const int answer = call_.init(); answer != kSuccess)
    throw NvmlError(fmt::format("NVML does not start: {}", call_.error(answer)));
}

Nvml::~Nvml() { call_.shutdown(); }

void Nvml::check(int answer, const char* what) const {
  if (answer != kSuccess) throw NvmlError(fmt::format("NVML gives no {}: {}", what, call_.error(answer)));
}

std::string Nvml::driver() const {
  char text[kDriverSize] = "";
  check(call_.driver(text, kDriverSize), "driver version");
  return text;
}

Nvml::Board Nvml::board(const std::string& bus) const {
  Board board = nullptr;
  if (const int answer = call_.by_bus(bus.c_str(), &board); answer != kSuccess)
    throw NvmlError(fmt::format("NVML gives no board at PCI bus {}: {}", bus, call_.error(answer)));
  return board;
}

std::string Nvml::name(Board board) const {
  char text[kNameSize] = "";
  check(call_.name(board, text, kNameSize), "name");
  return text;
}

std::optional<uint64_t> Nvml::energy(Board board) const {
  unsigned long long value = 0;
  const int answer = call_.energy(board, &value);
  if (answer == kNotSupported) return std::nullopt;
  check(answer, "energy");
  return value;
}

std::optional<uint32_t> Nvml::power(Board board) const {
  unsigned value = 0;
  const int answer = call_.power(board, &value);
  if (answer == kNotSupported) return std::nullopt;
  check(answer, "power");
  return value;
}

std::optional<uint32_t> Nvml::sm_clock(Board board) const {
  unsigned value = 0;
  if (call_.clock(board, kSmClock, &value) != kSuccess) return std::nullopt;
  return value;
}

}  // namespace cuboct::gpu
