// SPDX-License-Identifier: MIT
#include "model/base/parallel.h"

#include <linux/futex.h>
#include <strings.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace cuboct {
namespace {

using Clock = std::chrono::steady_clock;

// The serial work between two loops of an engine's step is some 10 us, a sleeper's way back as much.
constexpr auto kSpin = std::chrono::microseconds(50);
constexpr auto kActiveSpin = std::chrono::milliseconds(10);  // of a user who wants it
// A spin whose clock jumps so far was put aside: others want the core. For a while nobody spins then.
constexpr auto kPutAside = std::chrono::microseconds(500);
constexpr auto kCrowded = std::chrono::milliseconds(50);

// std::atomic's own wait yields before it sleeps: on a busy machine a thread that yields has lost its turn,
// one that sleeps is soon back.
void sleep_while(const std::atomic<uint32_t>& word, uint32_t value) {
  syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, value, nullptr, nullptr, 0);
}

void wake(const std::atomic<uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
}

// OpenMP's word for it is known to users: "passive" never spins, "active" does for long.
std::chrono::nanoseconds chosen_spin() {
  const char* const policy = std::getenv("OMP_WAIT_POLICY");
  if (policy == nullptr) return kSpin;
  if (strcasecmp(policy, "passive") == 0) return {};
  return strcasecmp(policy, "active") == 0 ? std::chrono::nanoseconds(kActiveSpin) : kSpin;
}

thread_local bool at_work = false;  // on a part

void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

class Team {
 public:
  Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() {
    stop_ = true;
    announce();
    for (std::thread& helper : helpers_) helper.join();
  }

  void run(size_t parts, int threads, PartCall call, const void* work) {
    grow(threads);
    spins_ = threads <= cores_ && spin_.count() > 0;
    parts_.store(parts, std::memory_order_relaxed);
    threads_.store(threads, std::memory_order_relaxed);
    call_.store(call, std::memory_order_relaxed);
    work_.store(work, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    ++number_;
    for (int m = 0; m < threads; ++m) {
      const auto own = static_cast<size_t>(m);
      const size_t left = own < parts ? (parts - own - 1) / static_cast<size_t>(threads) + 1 : 0;
      tickets_[own].left.store(uint64_t{number_} << 32 | left, std::memory_order_release);
    }
    announce();
    take_parts(0);
    const auto all = static_cast<uint32_t>(parts);
    const auto finished = [&] { return done_.load(std::memory_order_acquire) == all; };
    if (!spin_until(finished))
      for (uint32_t done = done_.load(); done != all; done = done_.load()) sleep_while(done_, done);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }

 private:
  // The parts m, m + threads, ... of member m: the loop's number above, what is left of them below. Whoever
  // lowers it has the part; one who comes from an earlier loop fails, as its number is another.
  struct alignas(64) Ticket {
    std::atomic<uint64_t> left{0};
  };

  void grow(int threads) {
    if (threads <= static_cast<int>(tickets_.size())) return;
    // Helpers look at the tickets: none may, while they are moved.
    stop_ = true;
    announce();
    for (std::thread& helper : helpers_) helper.join();
    helpers_.clear();
    stop_ = false;
    tickets_ = std::vector<Ticket>(static_cast<size_t>(threads));
    for (int m = 1; m < threads; ++m)
      helpers_.emplace_back([this, m, seen = announced_.load()] { help(m, seen); });
  }

  void announce() {
    announced_.fetch_add(1, std::memory_order_release);
    wake(announced_);
  }

  void help(int member, uint32_t seen) {
    while (true) {
      const auto called = [&] { return announced_.load(std::memory_order_acquire) != seen; };
      if (!spin_until(called))
        while (!called()) sleep_while(announced_, seen);
      seen = announced_.load(std::memory_order_acquire);
      if (stop_) return;
      take_parts(member);
    }
  }

  // Own parts first, which are those of the last loop and may still be in this core's cache.
  void take_parts(int member) {
    const auto size = static_cast<int>(tickets_.size());
    for (int k = 0, m = member; k < size; ++k, m = m + 1 < size ? m + 1 : 0)
      while (take_part(m, member)) {
      }
  }

  bool take_part(int of, int member) {
    std::atomic<uint64_t>& ticket = tickets_[static_cast<size_t>(of)].left;
    uint64_t left = ticket.load(std::memory_order_acquire);
    // Valid only if the exchange below succeeds: the loop cannot end before a part that was taken.
    const auto threads = static_cast<size_t>(threads_.load(std::memory_order_relaxed));
    const size_t parts = parts_.load(std::memory_order_relaxed);
    const PartCall call = call_.load(std::memory_order_relaxed);
    const void* const work = work_.load(std::memory_order_relaxed);
    if (static_cast<uint32_t>(left) == 0 || static_cast<size_t>(member) >= threads) return false;
    if (!ticket.compare_exchange_strong(left, left - 1, std::memory_order_acq_rel)) return true;
    const auto own = static_cast<size_t>(of);
    const size_t owned = (parts - own - 1) / threads + 1;
    at_work = true;
    try {
      call(work, own + threads * (owned - static_cast<uint32_t>(left)), member);
    } catch (...) {
      const std::lock_guard lock(throwing_);
      if (!thrown_) thrown_ = std::current_exception();
    }
    at_work = false;
    if (done_.fetch_add(1, std::memory_order_acq_rel) + 1 == parts) wake(done_);
    return true;
  }

  template <typename Done>
  bool spin_until(const Done& done) {
    if (done()) return true;
    if (!spins_) return false;
    const auto begin = Clock::now();
    if (begin.time_since_epoch().count() < crowded_until_) return false;
    for (auto last = begin; last - begin < spin_;) {
      for (int k = 0; k < 16; ++k) {
        if (done()) return true;
        relax();
      }
      const auto now = Clock::now();
      if (now - last > kPutAside) crowded_until_ = (now + kCrowded).time_since_epoch().count();
      last = now;
    }
    return done();
  }

  const int cores_ = usable_cores();
  const std::chrono::nanoseconds spin_ = chosen_spin();
  std::vector<std::thread> helpers_;
  std::vector<Ticket> tickets_;
  std::atomic<uint32_t> announced_{0};
  std::atomic<bool> stop_{false}, spins_{true};
  std::atomic<Clock::rep> crowded_until_{0};
  std::atomic<size_t> parts_{0};
  std::atomic<int> threads_{0};
  std::atomic<PartCall> call_{nullptr};
  std::atomic<const void*> work_{nullptr};
  alignas(64) std::atomic<uint32_t> done_{0};
  uint32_t number_ = 0;
  std::mutex throwing_;
  std::exception_ptr thrown_;
};

}  // namespace

void call_for_each_part(size_t parts, int threads, PartCall call, const void* work) {
  thread_local Team team;
  // Within a part the cores are taken already.
  if (at_work) {
    for (size_t part = 0; part < parts; ++part) call(work, part, 0);
    return;
  }
  team.run(parts, threads, call, work);
}

}  // namespace cuboct
