// SPDX-License-Identifier: MIT
// A device whose runs go on at once, each on a thread and a stream of its own: who may stay on it, and how
// much of it is one run's share. A process that has one run after the other needs nothing of it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

namespace cuboct::gpu {

// Blocks of one launch that wait for one another, so that all of them must be there at once.
struct Resident {
  unsigned blocks = 0;
  int each = 1;  // of such blocks a multiprocessor holds at once
};

// Whether all of these can be on a device of so many multiprocessors at once, wherever blocks of others were
// put. A block takes 1/each of a multiprocessor. Blocks of one size fill a device to the last. Of several
// sizes the largest, s, finds a place wherever less than 1 - s of each multiprocessor is taken on average.
inline bool fit_together(const std::vector<Resident>& residents, int multiprocessors) {
  double taken = 0, largest = 0, smallest = 1;
  uint64_t blocks = 0;
  for (const Resident& one : residents) {
    const double size = 1.0 / one.each;
    taken += one.blocks * size;
    blocks += one.blocks;
    largest = size > largest ? size : largest;
    smallest = size < smallest ? size : smallest;
  }
  if (smallest == largest)
    return blocks <= uint64_t(residents[0].each) * static_cast<uint64_t>(multiprocessors);
  constexpr double kRounding = 1e-9;
  return taken <= multiprocessors * (1 - largest) + largest + kRounding;
}

class Sharing {
 public:
  static Sharing& all() {
    static Sharing sharing;
    return sharing;
  }

  // From now on runs go on at once: to be called before the first device is used.
  void begin() { on_ = true; }
  bool on() const { return on_; }

  // A run that goes on, of those among which a device is parted.
  class Run {
   public:
    Run() { ++all().runs_; }
    ~Run() { --all().runs_; }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;
  };
  // What one run may take of a device that holds so many blocks, where it has a choice.
  unsigned share_of(unsigned blocks) const {
    const int runs = runs_;
    return on_ && runs > 1 ? blocks / static_cast<unsigned>(runs) : blocks;
  }

  // Waits until there is room, in the order of asking; the room is free again at the end of the object.
  class Stay {
   public:
    Stay(int device, const Resident& one, int multiprocessors) : device_(device), one_(one) {
      if (!all().on_) return;
      std::unique_lock lock(all().guard_);
      const uint64_t turn = all().asked_++;
      all().changed_.wait(lock, [&] {
        std::vector<Resident> there = all().there_[device_];
        there.push_back(one_);
        return all().turn_ == turn && fit_together(there, multiprocessors);
      });
      ++all().turn_;
      all().there_[device_].push_back(one_);
      stays_ = true;
      all().changed_.notify_all();
    }
    ~Stay() {
      if (!stays_) return;
      const std::lock_guard lock(all().guard_);
      std::vector<Resident>& there = all().there_[device_];
      for (size_t k = 0; k < there.size(); ++k)
        if (there[k].blocks == one_.blocks && there[k].each == one_.each) {
          there.erase(there.begin() + static_cast<std::ptrdiff_t>(k));
          break;
        }
      all().changed_.notify_all();
    }
    Stay(const Stay&) = delete;
    Stay& operator=(const Stay&) = delete;

   private:
    int device_;
    Resident one_;
    bool stays_ = false;
  };

 private:
  std::atomic<bool> on_ = false;
  std::atomic<int> runs_ = 0;
  std::mutex guard_;  // of what follows
  std::condition_variable changed_;
  uint64_t asked_ = 0, turn_ = 0;
  std::map<int, std::vector<Resident>> there_;  // by device
};

}  // namespace cuboct::gpu
