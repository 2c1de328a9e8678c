// SPDX-License-Identifier: MIT
#include "model/base/resources.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

namespace cuboct {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

// The first number of a file; none where it holds "max" or is not there.
std::optional<uint64_t> number_in(const fs::path& path) {
  std::ifstream in(path);
  uint64_t number = 0;
  return in >> number ? std::optional(number) : std::nullopt;
}

// kB behind `name` in a file of "name: number kB" lines, in bytes.
std::optional<uint64_t> bytes_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name + ":")) continue;
    return std::stoull(line.substr(name.size() + 1)) * 1024;
  }
  return std::nullopt;
}

// This process's directory of a control group's controller ("": version 2), where it is mounted as usual.
std::string group_of(const std::string& controller) {
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    std::istringstream names(line.substr(first + 1, second - first - 1));
    if (controller.empty() && second == first + 1) return line.substr(second + 1);
    for (std::string name; std::getline(names, name, ',');)
      if (!controller.empty() && name == controller) return line.substr(second + 1);
  }
  return "";
}

// Calls see(directory) for the group and those above it. In a container the root of the mount may be the
// group itself.
template <typename See>
void for_each_group(const fs::path& mount, const std::string& group, const See& see) {
  for (fs::path at = group; at.has_relative_path(); at = at.parent_path()) see(mount / at.relative_path());
  see(mount);
}

uint64_t free_in_groups() {
  uint64_t least = kUnlimited;
  const auto meet = [&](const fs::path& group, const char* limit, const char* used, const char* cache) {
    const auto most = number_in(group / limit), now = number_in(group / used);
    if (!most || !now) return;
    // Pages of files are given up where memory is short.
    uint64_t pages = 0;
    std::ifstream stat(group / "memory.stat");
    for (std::string name; stat >> name;) {
      uint64_t value = 0;
      stat >> value;
      if (name == cache) pages = value;
    }
    const uint64_t held = *now - std::min(*now, pages);
    least = std::min(least, *most - std::min(*most, held));
  };
  for_each_group("/sys/fs/cgroup", group_of(""), [&](const fs::path& group) {
    meet(group, "memory.max", "memory.current", "inactive_file");
  });
  for_each_group("/sys/fs/cgroup/memory", group_of("memory"), [&](const fs::path& group) {
    meet(group, "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file");
  });
  return least;
}

// Cores that the groups' quotas pay for.
double quota() {
  double least = std::numeric_limits<double>::infinity();
  for_each_group("/sys/fs/cgroup", group_of(""), [&](const fs::path& group) {
    std::ifstream in(group / "cpu.max");
    double share = 0, period = 0;
    if (in >> share >> period && period > 0) least = std::min(least, share / period);
  });
  for_each_group("/sys/fs/cgroup/cpu", group_of("cpu"), [&](const fs::path& group) {
    const auto share = number_in(group / "cpu.cfs_quota_us"), period = number_in(group / "cpu.cfs_period_us");
    if (share && period && *period > 0 && *share < kUnlimited / 2)  // -1: none
      least = std::min(least, static_cast<double>(*share) / static_cast<double>(*period));
  });
  return least;
}

int counted_cores() {
  // Of 1024 cores and more the set would have to be larger: then all count.
  cpu_set_t set;
  const int cores = sched_getaffinity(0, sizeof set, &set) == 0
                        ? CPU_COUNT(&set)
                        : static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  return static_cast<int>(std::clamp(std::ceil(quota()), 1.0, static_cast<double>(std::max(1, cores))));
}

}  // namespace

int usable_cores() {
  static const int cores = counted_cores();
  return cores;
}

uint64_t free_memory() {
  uint64_t least = std::min(bytes_of("/proc/meminfo", "MemAvailable").value_or(kUnlimited), free_in_groups());
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    const uint64_t used = bytes_of("/proc/self/status", "VmSize").value_or(0);
    least = std::min<uint64_t>(least, limit.rlim_cur - std::min<uint64_t>(limit.rlim_cur, used));
  }
  return least;
}

std::string in_bytes(double bytes) {
  constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
  size_t unit = 0;
  for (; bytes >= 999.5 && unit + 1 < std::size(kUnits); ++unit) bytes /= 1000;
  return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

std::string cache_directory() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != 0)
    return (fs::path(cache) / "cuboct").string();
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    return (fs::path(home) / ".cache" / "cuboct").string();
  return {};
}

uint64_t free_disk(const std::string& path) {
  std::error_code none;
  fs::path at = fs::absolute(path, none);
  while (!fs::exists(at, none) && at.has_relative_path()) at = at.parent_path();
  const fs::space_info space = fs::space(at, none);
  // One of the kernel's own, as /proc, has no blocks: why nothing can be written there, the write says.
  return none || space.capacity == 0 ? kUnlimited : space.available;
}

}  // namespace cuboct
