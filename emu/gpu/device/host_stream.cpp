// SPDX-License-Identifier: MIT
#include "emu/gpu/device/host_stream.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace cuboct::gpu {

Shuffle& Shuffle::all() {
  static Shuffle shuffle;
  return shuffle;
}

namespace {

// For tests (tests/faults): from its CUBOCT_FAIL_AT-th call on the device is lost, where CUBOCT_FAIL_CALL is
// "device". As CUDA's, launches fail where somebody waits for them.
void call_device(const char* what) {
  static const long at = [] {
    const char *call = std::getenv("CUBOCT_FAIL_CALL"), *number = std::getenv("CUBOCT_FAIL_AT");
    return call != nullptr && number != nullptr && std::string_view(call) == "device" ? std::atol(number) : 0;
  }();
  static std::atomic<long> count = 0;
  if (at == 0) return;
  const long number = ++count;
  if (number < at) return;
  if (const char* mark = std::getenv("CUBOCT_FAIL_MARK"); mark != nullptr && number == at)
    if (std::FILE* file = std::fopen(mark, "w")) std::fprintf(file, "device 0"), std::fclose(file);
  throw std::runtime_error(std::string("CUDA: ") + what + ": unspecified launch failure");
}

}  // namespace

Stream::Stream(int device, bool) : device_(device) {
  call_device("make a stream");
  if (Shuffle::all().on) Shuffle::all().streams.push_back(this);
}

Stream::~Stream() {
  try {
    synchronize();
  } catch (const std::runtime_error&) {  // a lost device has nothing to wait for
  }
  std::erase(Shuffle::all().streams, this);
}

void Stream::record(Event& event) {
  call_device("record an event");
  ++event.issued_;
  later([&event] { ++event.reached_; });
}

void Stream::wait(const Event& event) {
  call_device("wait for an event");
  if (Shuffle::all().on) add({&event, event.issued_, [] {}});
}

void Stream::synchronize() {
  call_device("run on the device");
  while (!queue_.empty()) go_on();
}

void Stream::finish(int device) {
  for (;;) {
    bool idle = true;
    for (const Stream* stream : Shuffle::all().streams)
      idle = idle && (stream->device_ != device || stream->queue_.empty());
    if (idle) return;
    go_on();
  }
}

void Stream::add(Call call) {
  call.number = Shuffle::all().calls++;
  queue_.push_back(std::move(call));
}

bool Stream::ready() const {
  return !queue_.empty() &&
         (!queue_.front().event || queue_.front().event->reached_ >= queue_.front().reached);
}

// Some stream, as far as it gets or a few calls.
void Stream::go_on() {
  Shuffle& all = Shuffle::all();
  std::vector<Stream*> able;
  for (Stream* stream : all.streams)
    if (stream->ready()) able.push_back(stream);
  if (able.empty()) throw std::logic_error("streams wait for one another");
  Stream& one = *able[all.random() % able.size()];
  for (uint64_t burst = 1 + all.random() % 6; burst > 0 && one.ready(); --burst) {
    const Call call = std::move(one.queue_.front());
    one.queue_.pop_front();
    for (const Stream* other : all.streams)
      if (!other->queue_.empty() && other->queue_.front().number < call.number) {
        ++all.overtaken;
        break;
      }
    call.work();
  }
}

}  // namespace cuboct::gpu
