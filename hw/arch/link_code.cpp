// SPDX-License-Identifier: MIT
#include "hw/arch/link_code.h"

#include <fmt/format.h>

#include <charconv>

#include "model/base/enum_names.h"
#include "model/base/error.h"

namespace cuboct {
namespace {

// A beat goes through the sender's wire register and the receiver's checked register (2 cycles); its
// acknowledgement through the receiver's and the sender's register: the sender knows of it in the 4th cycle
// after the one that took the beat. A window of 8 is never full without a fault, and 15 cycles of silence
// mean that nothing comes.
constexpr int kSequenceBits = 4, kWindow = 8, kPatience = 15, kLatency = 2;

// The best checks of 16 bits by length (Koopman, https://users.ece.cmu.edu/~koopman/crc/): the most message
// bits at which this many wrong bits less one are always found. In his notation 0x9eb2, 0xac9a, 0x8810.
struct Best {
  int message_bits;
  uint32_t polynomial;
  int distance;
};
constexpr Best kBeat[] = {{135, 0x3D65, 6}, {241, 0x5935, 5}, {32751, 0x1021, 4}};
// 8 bits over 4: distance 6 (0x9b in the same tables).
constexpr Crc kAck{8, 0x37, 0xFF};

}  // namespace

CrcTable::CrcTable(const Crc& crc) : start_(crc.start) {
  for (int k = 0; k < crc.width; ++k) reversed_ |= (crc.polynomial >> k & 1) << (crc.width - 1 - k);
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t r = byte;
    for (int k = 0; k < 8; ++k) r = r >> 1 ^ ((r & 1) != 0 ? reversed_ : 0);
    table_[byte] = r;
  }
}

uint32_t CrcTable::operator()(const uint64_t* words, int bits) const {
  uint32_t r = start_;
  int at = 0;
  for (; at + 8 <= bits; at += 8) {
    const auto byte = static_cast<uint32_t>(words[at >> 6] >> (at & 63) & 0xFF);
    r = r >> 8 ^ table_[(r ^ byte) & 0xFF];
  }
  for (; at < bits; ++at) {
    const bool out = (r & 1) != (words[at >> 6] >> (at & 63) & 1);
    r = r >> 1 ^ (out ? reversed_ : 0);
  }
  return r;
}

const char* to_string(LinkCheck check) {
  constexpr const char* kNames[] = {"none", "detect", "retry"};
  return name_in(kNames, check);
}

FaultShare read_fault_share(const std::string& text) {
  FaultShare share;
  const char *begin = text.data(), *end = begin + text.size();
  if (const auto whole = std::from_chars(begin, end, share.count);
      whole.ec == std::errc() && whole.ptr == end && share.count > 0)
    return share;
  share.count = 0;
  if (const auto real = std::from_chars(begin, end, share.rate);
      real.ec == std::errc() && real.ptr == end && share.rate > 0 && share.rate < 1)
    return share;
  throw InputError(fmt::format("'{}' faults cannot be injected", text),
                   "give a share of all beats, as 0.001, or their number in the run, as 10000");
}

LinkCode link_code(LinkCheck check, int link_bits) {
  LinkCode code;
  code.check = check;
  code.wire_bits = link_bits;
  if (!code.checked()) return code;
  code.sequence_bits = kSequenceBits;
  code.window = kWindow;
  code.patience = kPatience;
  code.latency = kLatency;
  code.ack = kAck;
  const int message = kSequenceBits + 1 + link_bits;
  const Best* best = kBeat;
  while (message > best->message_bits) ++best;  // links have at most 1024 bits (hw/plan/plan.cpp)
  code.beat = {16, best->polynomial, 0xFFFF};
  code.distance = best->distance;
  code.wire_bits = kSequenceBits + link_bits + code.beat.width;
  code.ack_bits = kSequenceBits + code.ack.width;
  return code;
}

}  // namespace cuboct
