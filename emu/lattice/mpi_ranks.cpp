// SPDX-License-Identifier: MIT
#include "emu/lattice/mpi_ranks.h"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <thread>

namespace cuboct::emu {
namespace {

// MPI counts in int.
int checked(size_t count) {
  if (count > static_cast<size_t>(std::numeric_limits<int>::max()))
    throw std::runtime_error("a message between ranks of more than 2^31 - 1 elements: use more ranks");
  return static_cast<int>(count);
}

struct Layout {
  std::vector<int> count, at;
  int total = 0;
  explicit Layout(const std::vector<int>& counts) : count(counts), at(counts.size()) {
    size_t sum = 0;
    for (size_t q = 0; q < counts.size(); ++q) {
      at[q] = checked(sum);
      sum += static_cast<size_t>(counts[q]);
    }
    total = checked(sum);
  }
};

// Most waits are short and spin. One that is not sleeps between looks, as the rank that it waits for, or
// somebody else, may want this core. A yielded turn is gone for milliseconds beside strangers; a sleeper is
// soon back.
constexpr auto kSpin = std::chrono::microseconds(100), kSpinWithoutACore = std::chrono::microseconds(20);
constexpr std::chrono::nanoseconds kShortestSleep = std::chrono::microseconds(5),
                                   kLongestSleep = std::chrono::microseconds(50);
// A message in pieces takes some calls in a row.
constexpr int kCallsOfALook = 4;

bool every_rank_has_a_core() {
  MPI_Comm here;
  int ranks = 1;
  if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here) != MPI_SUCCESS)
    return false;
  MPI_Comm_size(here, &ranks);
  MPI_Comm_free(&here);
  return ranks <= get_nprocs();
}

// `code`: what `call` returned.
void check(int rank, std::string_view call, int code) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int size = 0;
  MPI_Error_string(code, text.data(), &size);
  throw std::runtime_error(fmt::format("{} failed in rank {}: {}", call, rank,
                                       std::string_view(text.data(), static_cast<size_t>(size))));
}

}  // namespace

MpiRanks::MpiRanks(int* argc, char*** argv) {
  int provided = 0;
  // Open MPI would yield at each look of wait() where it takes the machine for full: on a busy one who yields
  // has lost its turn for milliseconds, who sleeps is soon back. What a user sets stays.
  setenv("OMPI_MCA_mpi_yield_when_idle", "0", 0);
  prctl(PR_SET_TIMERSLACK, 1000);  // ns; by default sleeps are 50 us longer than asked for
  // Threads compute; only the first one talks.
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  spin_ = every_rank_has_a_core() ? kSpin : kSpinWithoutACore;
}

MpiRanks::~MpiRanks() {
  // MPI's own wait for the last rank, which may be writing files, takes a core.
  MPI_Request request;
  try {
    if (MPI_Ibarrier(MPI_COMM_WORLD, &request) == MPI_SUCCESS) wait({&request, 1});
  } catch (const std::runtime_error&) {  // of a wait that MPI's own takes the place of
  }
  MPI_Finalize();
}

void MpiRanks::give_up(int code) {
  if (size_ > 1) MPI_Abort(MPI_COMM_WORLD, code);
}

void MpiRanks::wait(std::span<MPI_Request> requests) const {
  const auto begin = std::chrono::steady_clock::now();
  auto sleep = kShortestSleep;
  for (;;) {
    for (int call = 0, done = 0; call < kCallsOfALook; ++call) {
      check(rank_, "MPI_Testall",
            MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE));
      if (done != 0) return;
    }
    if (std::chrono::steady_clock::now() - begin < spin_) continue;
    std::this_thread::sleep_for(sleep);
    sleep = std::min(2 * sleep, kLongestSleep);
  }
}

void MpiRanks::sum(std::span<uint64_t> values) {
  MPI_Request request;
  check(rank_, "MPI_Iallreduce",
        MPI_Iallreduce(MPI_IN_PLACE, values.data(), checked(values.size()), MPI_UINT64_T, MPI_SUM,
                       MPI_COMM_WORLD, &request));
  wait({&request, 1});
}

void MpiRanks::most(std::span<double> values) {
  MPI_Request request;
  check(rank_, "MPI_Iallreduce",
        MPI_Iallreduce(MPI_IN_PLACE, values.data(), checked(values.size()), MPI_DOUBLE, MPI_MAX,
                       MPI_COMM_WORLD, &request));
  wait({&request, 1});
}

void MpiRanks::any(std::span<uint8_t> flags) {
  MPI_Request request;
  check(rank_, "MPI_Iallreduce",
        MPI_Iallreduce(MPI_IN_PLACE, flags.data(), checked(flags.size()), MPI_UINT8_T, MPI_BOR,
                       MPI_COMM_WORLD, &request));
  wait({&request, 1});
}

std::vector<Bytes> MpiRanks::exchange(const std::vector<Bytes>& to) {
  std::vector<int> out(to.size()), in(to.size());
  for (size_t q = 0; q < to.size(); ++q) out[q] = checked(to[q].size());
  MPI_Request request;
  check(rank_, "MPI_Ialltoall",
        MPI_Ialltoall(out.data(), 1, MPI_INT, in.data(), 1, MPI_INT, MPI_COMM_WORLD, &request));
  wait({&request, 1});
  const Layout send(out), receive(in);
  Bytes sent, received(static_cast<size_t>(receive.total));
  sent.reserve(static_cast<size_t>(send.total));
  for (const Bytes& b : to) sent.insert(sent.end(), b.begin(), b.end());
  check(rank_, "MPI_Ialltoallv",
        MPI_Ialltoallv(sent.data(), send.count.data(), send.at.data(), MPI_BYTE, received.data(),
                       receive.count.data(), receive.at.data(), MPI_BYTE, MPI_COMM_WORLD, &request));
  wait({&request, 1});
  std::vector<Bytes> from(to.size());
  for (size_t q = 0; q < to.size(); ++q)
    from[q].assign(received.begin() + receive.at[q], received.begin() + receive.at[q] + receive.count[q]);
  return from;
}

Bytes MpiRanks::all(const Bytes& mine) {
  const int count = checked(mine.size());
  std::vector<int> counts(static_cast<size_t>(size_));
  MPI_Request request;
  check(rank_, "MPI_Iallgather",
        MPI_Iallgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD, &request));
  wait({&request, 1});
  const Layout layout(counts);
  Bytes received(static_cast<size_t>(layout.total));
  check(rank_, "MPI_Iallgatherv",
        MPI_Iallgatherv(mine.data(), count, MPI_BYTE, received.data(), layout.count.data(), layout.at.data(),
                        MPI_BYTE, MPI_COMM_WORLD, &request));
  wait({&request, 1});
  return received;
}

void MpiRanks::start(const std::vector<std::span<const double>>& to,
                     const std::vector<std::span<double>>& from) {
  for (int q = 0; q < size_; ++q)
    if (const auto& place = from[static_cast<size_t>(q)]; !place.empty())
      check(rank_, "MPI_Irecv",
            MPI_Irecv(place.data(), checked(place.size()), MPI_DOUBLE, q, 0, MPI_COMM_WORLD,
                      &requests_.emplace_back()));
  for (int q = 0; q < size_; ++q)
    if (const auto& message = to[static_cast<size_t>(q)]; !message.empty())
      check(rank_, "MPI_Isend",
            MPI_Isend(message.data(), checked(message.size()), MPI_DOUBLE, q, 0, MPI_COMM_WORLD,
                      &requests_.emplace_back()));
}

void MpiRanks::finish() {
  wait(requests_);
  requests_.clear();
}

}  // namespace cuboct::emu
