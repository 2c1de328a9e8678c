// SPDX-License-Identifier: MIT
#include "emu/gpu/device/host_stream.h"

#include <stdexcept>
#include <utility>

namespace cuboct::gpu {

Shuffle& Shuffle::all() {
  static Shuffle shuffle;
  return shuffle;
}

Stream::Stream(int device, bool) : device_(device) {
  if (Shuffle::all().on) Shuffle::all().streams.push_back(this);
}

Stream::~Stream() {
  synchronize();
  std::erase(Shuffle::all().streams, this);
}

void Stream::record(Event& event) {
  ++event.issued_;
  later([&event] { ++event.reached_; });
}

void Stream::wait(const Event& event) {
  if (Shuffle::all().on) add({&event, event.issued_, [] {}});
}

void Stream::synchronize() {
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
