// SPDX-License-Identifier: MIT
// When beats go over links between devices, in the timing model: docs/reference/boards.md, "Recurrences".
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct::emu {

// The sending ends of all links. A beat that a register loads in cycle t is taken from it in T >= t + 1: at
// once on a wire, and once the link can on one between devices. The register can load again in T. Different
// nodes may be asked and told by different threads.
class DeviceLinks {
 public:
  static constexpr int64_t kLongAgo = INT64_MIN / 4;
  // Keeps a reference to `plan`.
  explicit DeviceLinks(const Plan& plan)
      : cut_(plan.cut), latency_(plan.arch.boards.latency), interval_(plan.arch.boards.interval) {
    if (any()) taken_.resize(cut_.size());
    for (auto& faces : taken_) faces.fill(kLongAgo);
  }

  bool any() const { return !cut_.empty(); }
  // Whether what node `n` sends over `face` goes to another device; `n` may be one beyond the last.
  bool cut(uint32_t n, int face) const { return n < cut_.size() && (cut_[n] >> face & 1) != 0; }
  // The first cycle in which the registers of these faces can load.
  int64_t can_load(uint32_t n, uint8_t faces) const {
    int64_t cycle = kLongAgo;
    for (int f = 0; f < kFaces && any(); ++f)
      if ((faces & cut_[n]) >> f & 1) cycle = std::max(cycle, taken_[n][static_cast<size_t>(f)]);
    return cycle;
  }
  // Loads `beats` >= 1 beats into the registers of all `faces` in lock step, one after the other, the first
  // one in `from` or later. Returns the cycle that loads the last.
  int64_t load(uint32_t n, uint8_t faces, int64_t from, int64_t beats) {
    if (!any() || (faces & cut_[n]) == 0) return from + beats - 1;
    int64_t loaded = from - 1;
    for (; beats > 0; --beats) {
      loaded = std::max(loaded + 1, can_load(n, faces));
      for (int f = 0; f < kFaces; ++f)
        if ((faces & cut_[n]) >> f & 1) {
          int64_t& taken = taken_[n][static_cast<size_t>(f)];
          taken = std::max(loaded + 1, taken + interval_);
        }
    }
    return loaded;
  }
  // The cycle in which the neighbour's node sees the last beat that was loaded over a face that is cut.
  int64_t seen(uint32_t n, int face) const { return taken_[n][static_cast<size_t>(face)] + latency_ + 1; }

  // All that later steps depend on, behind what `starts` holds; and back.
  void save(std::vector<uint64_t>& starts) const {
    for (const auto& faces : taken_)
      for (const int64_t taken : faces) starts.push_back(static_cast<uint64_t>(taken));
  }
  size_t saved() const { return taken_.size() * kFaces; }
  void load_state(std::span<const uint64_t> saved) {
    for (size_t k = 0; k < saved.size(); ++k) taken_[k / kFaces][k % kFaces] = static_cast<int64_t>(saved[k]);
  }

 private:
  const std::vector<uint8_t>& cut_;
  const int64_t latency_, interval_;
  std::vector<std::array<int64_t, kFaces>> taken_;  // [node][face]: T of the last beat
};

// Both faces of an axis.
constexpr uint8_t faces_along(int axis) { return static_cast<uint8_t>(3u << (2 * axis)); }

}  // namespace cuboct::emu
