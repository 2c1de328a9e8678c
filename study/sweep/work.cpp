// SPDX-License-Identifier: MIT
#include "study/sweep/work.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

#include "model/base/clock.h"
#include "model/base/progress.h"
#include "model/base/resources.h"

namespace cuboct::study {
namespace {

struct Board {
  std::mutex mutex;
  std::condition_variable changed;
  size_t next = 0, done = 0, running = 0;
  double done_size = 0;
  std::exception_ptr error;
};

std::string status(const Board& board, size_t count, double size, const std::string& label,
                   Clock::time_point begin) {
  const double seconds = seconds_since(begin);
  std::string left;
  if (board.done_size > 0) {
    const auto rest = static_cast<uint64_t>(seconds * (size - board.done_size) / board.done_size);
    left = fmt::format(", {}:{:02} left", rest / 60, rest % 60);
  }
  return fmt::format("{}: {} of {}{}", label, board.done, count, left);
}

void worker(const std::vector<Piece>& pieces, Board& board) {
  for (;;) {
    size_t mine = 0;
    {
      const std::lock_guard guard(board.mutex);
      if (board.error || board.next == pieces.size()) return;
      mine = board.next++;
    }
    std::exception_ptr error;
    try {
      pieces[mine].work();
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard guard(board.mutex);
    if (error && !board.error) board.error = error;
    ++board.done;
    board.done_size += pieces[mine].size;
  }
}

}  // namespace

void work_off(std::vector<Piece> pieces, int jobs, const std::string& label, bool progress) {
  std::ranges::stable_sort(pieces, std::greater(), &Piece::size);
  double size = 0;
  for (const Piece& piece : pieces) size += piece.size;
  Board board;
  const size_t most = jobs > 0 ? static_cast<size_t>(jobs) : static_cast<size_t>(usable_cores());
  std::vector<std::thread> threads;
  const size_t count = std::min(most, pieces.size());
  threads.reserve(count);
  board.running = count;
  const auto work = [&] {
    worker(pieces, board);
    const std::lock_guard guard(board.mutex);
    --board.running;
    board.changed.notify_all();
  };
  for (size_t k = 0; k < count; ++k) try {
      threads.emplace_back(work);
    } catch (const std::system_error&) {  // fewer take longer, but there must be one
      if (k == 0) throw;
      const std::lock_guard guard(board.mutex);
      board.running -= count - k;
      break;
    }
  const auto begin = Clock::now();
  {
    StatusLine line;
    std::unique_lock guard(board.mutex);
    while (board.running > 0) {
      if (progress) line.say(status(board, pieces.size(), size, label, begin));
      board.changed.wait_for(guard, std::chrono::milliseconds(500));
    }
  }
  for (std::thread& thread : threads) thread.join();
  if (board.error) std::rethrow_exception(board.error);
}

}  // namespace cuboct::study
