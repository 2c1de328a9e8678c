// SPDX-License-Identifier: MIT
#include "tests/gpu/fake_nvml.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string_view>

#define EXPORT extern "C" __attribute__((visibility("default")))

using cuboct::test::FakeBoard;
using cuboct::test::FakeNvml;

EXPORT FakeNvml fake_nvml;
FakeNvml fake_nvml;

namespace {

constexpr int kSuccess = 0, kInvalid = 2, kNotSupported = 3, kNotFound = 6, kLost = 15;

double now() {
  if (fake_nvml.time != nullptr) return *fake_nvml.time;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The time of the latest update.
double updated(const FakeBoard& board) {
  return board.time[0] + std::floor((now() - board.time[0]) / board.period) * board.period;
}

double joules(const FakeBoard& board, double until) {
  double sum = 0;
  for (int k = 0; k < board.pieces; ++k) {
    const double end = k + 1 < board.pieces ? std::min(board.time[k + 1], until) : until;
    sum += board.watts[k] * std::max(0.0, end - board.time[k]);
  }
  return sum;
}

double watts(const FakeBoard& board, double at) {
  double value = board.watts[0];
  for (int k = 1; k < board.pieces; ++k)
    if (board.time[k] <= at) value = board.watts[k];
  return value;
}

}  // namespace

EXPORT int nvmlInit_v2() {
  if (fake_nvml.init == kSuccess) ++fake_nvml.sessions;
  return fake_nvml.init;
}

EXPORT int nvmlShutdown() {
  --fake_nvml.sessions;
  return kSuccess;
}

EXPORT const char* nvmlErrorString(int answer) {
  switch (answer) {
    case kNotFound:
      return "Not Found";
    case 9:
      return "Driver Not Loaded";
    case kLost:
      return "GPU is lost";
    default:
      return "?";
  }
}

EXPORT int nvmlSystemGetDriverVersion(char* text, unsigned size) {
  std::strncpy(text, "123.45.06", size);
  return kSuccess;
}

EXPORT int nvmlDeviceGetHandleByPciBusId_v2(const char* bus, FakeBoard** board) {
  for (int k = 0; k < fake_nvml.count; ++k)
    if (std::string_view(fake_nvml.boards[k].bus) == bus) {
      *board = &fake_nvml.boards[k];
      return kSuccess;
    }
  return kNotFound;
}

EXPORT int nvmlDeviceGetName(FakeBoard*, char* text, unsigned size) {
  std::strncpy(text, "Fake H100", size);
  return kSuccess;
}

EXPORT int nvmlDeviceGetTotalEnergyConsumption(FakeBoard* board, unsigned long long* value) {
  if (!board->energy) return kNotSupported;
  if (now() > board->lost) return kLost;
  const double at = updated(*board);
  const uint64_t before = board->counted;
  *value = at >= board->loaded_anew
               ? static_cast<uint64_t>(1e3 * (joules(*board, at) - joules(*board, board->loaded_anew)))
               : before + static_cast<uint64_t>(1e3 * joules(*board, at));
  return kSuccess;
}

EXPORT int nvmlDeviceGetPowerUsage(FakeBoard* board, unsigned* value) {
  if (!board->power) return kNotSupported;
  if (now() > board->lost) return kLost;
  *value = static_cast<unsigned>(std::lround(1e3 * watts(*board, updated(*board))));
  return kSuccess;
}

EXPORT int nvmlDeviceGetClockInfo(FakeBoard* board, int type, unsigned* value) {
  if (type != 1) return kInvalid;
  if (board->clock == 0) return kNotSupported;
  *value = board->clock;
  return kSuccess;
}
