// SPDX-License-Identifier: MIT
// The processes that share a scene. Every call is collective: all ranks make the same calls in the same
// order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace cuboct::emu {

using Bytes = std::vector<std::byte>;

// Values as bytes, one behind the other, and back.
template <typename T>
void append(Bytes& bytes, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* from = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}
template <typename T, typename See>
void for_each_of(const Bytes& bytes, const See& see) {
  for (size_t k = 0; k < bytes.size(); k += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + k, sizeof value);
    see(value);
  }
}

class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  // Element by element over all ranks.
  virtual void sum(std::span<uint64_t> values) = 0;
  virtual void most(std::span<double> values) = 0;
  virtual void any(std::span<uint8_t> flags) = 0;
  // `to[q]` goes to rank q; what rank q sent here comes back in [q].
  virtual std::vector<Bytes> exchange(const std::vector<Bytes>& to) = 0;
  // What all ranks gave, in the order of ranks.
  virtual Bytes all(const Bytes& mine) = 0;

  // One message to and from each rank (empty: none), under way until finish() returns; the memory must stay.
  virtual void start(const std::vector<std::span<const double>>& to,
                     const std::vector<std::span<double>>& from) = 0;
  virtual void finish() = 0;

  // Of one rank alone: ends all with this exit code. Others would wait for one that met an error for ever.
  virtual void give_up(int code) = 0;
};

}  // namespace cuboct::emu
