// SPDX-License-Identifier: MIT
// What protects the beats of a link: a sequence number, a cyclic redundancy check, and the acknowledgements
// that come back. docs/reference/links.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace cuboct {

// A cyclic redundancy check, reflected: bit 0 of the message has the highest power of x and comes first, and
// so has bit 0 of the remainder.
struct Crc {
  int width = 0;            // 8 to 32
  uint32_t polynomial = 0;  // without the leading term x^width; bit k is the coefficient of x^k
  uint32_t start = 0;       // the remainder before the first bit
  bool operator==(const Crc&) const = default;
};

// A check with its table of bytes (Sarwate, CACM 31, 1988).
class CrcTable {
 public:
  explicit CrcTable(const Crc& crc);
  // Of the low `bits` bits of `words`, the least significant word first; bits >= 0.
  uint32_t operator()(const uint64_t* words, int bits) const;

 private:
  uint32_t reversed_ = 0;  // the polynomial, its highest coefficient in bit 0
  uint32_t start_;
  std::array<uint32_t, 256> table_;
};

enum class LinkCheck : uint8_t {
  none,    // a beat is payload and end
  detect,  // a wrong, lost or repeated beat stops the run
  retry    // ... is sent again
};
const char* to_string(LinkCheck check);

// The code of a plan's links, least significant first:
//   beat             payload[link_bits] end sequence[sequence_bits] crc[beat.width]
//   acknowledgement  sequence[sequence_bits] crc[ack.width]
// Each check goes over all that stands before it. Without a check a beat is payload and end.
struct LinkCode {
  LinkCheck check = LinkCheck::none;
  int sequence_bits = 0;
  int window = 0;    // beats that may be unacknowledged; a power of two below 2^sequence_bits
  int patience = 0;  // cycles of silence after which a sender gives its beats up for lost
  Crc beat, ack;
  int distance = 0;   // fewer wrong bits than this in a beat are always found
  int wire_bits = 0;  // of the port link_data: a beat but for `end`, which has a port of its own
  int ack_bits = 0;   // of the port link_ack
  int latency = 0;    // cycles that a beat takes longer than without a check
  bool checked() const { return check != LinkCheck::none; }
};

// How many faults a run is to meet on its links: a share of all beats, or a number in the run.
struct FaultShare {
  double rate = 0;     // below 1
  uint64_t count = 0;  // 0 where a rate is given
};
// "0.001" or "10000". Throws InputError.
FaultShare read_fault_share(const std::string& text);

// `link_bits`: payload, 1 to 1024.
LinkCode link_code(LinkCheck check, int link_bits);

}  // namespace cuboct
