// SPDX-License-Identifier: MIT
#include "tests/verify/ports.h"

#include <fmt/format.h>

#include <stdexcept>

#include "model/base/hash.h"

namespace cuboct::test {
namespace {

using emu::NodeInputs;
using emu::NodeModel;
using emu::NodeOutputs;

template <int kWords>
void add(Hash& hash, const emu::BitsOf<kWords>& bits) {
  for (const uint64_t word : bits.word) hash.add(word);
}

class Watcher : public NodeModel {
 public:
  Watcher(std::unique_ptr<NodeModel> node, uint8_t has_link) : node_(std::move(node)), has_link_(has_link) {}

  void clock(const NodeInputs& in, NodeOutputs& out) override {
    node_->clock(in, out);
    for (size_t f = 0; f < held_.size(); ++f)
      if (out.loaded >> f & 1) held_[f] = *out.beat[f];
    // Before reset a node may show anything.
    if (in.control->reset_n) see(shown(out));
  }
  std::string doing() const override { return node_->doing(); }
  emu::Counters counters(uint64_t end) const override { return node_->counters(end); }

 protected:
  virtual void see(const Shown& shown) = 0;

 private:
  Shown shown(const NodeOutputs& out) const {
    Shown s{};
    const auto at = [&s](PortGroup group) -> uint64_t& { return s[static_cast<size_t>(group)]; };
    at(PortGroup::phases) = static_cast<uint64_t>(out.phase_start << 8 | out.phase_end);
    at(PortGroup::idle) = out.idle;
    if (out.observe) {
      Hash hash;
      add(hash, out.observe_data);
      hash.add(uint64_t{out.observe_cell});
      at(PortGroup::observe) = hash.value();
    }
    if (out.fault) {
      Hash hash;
      hash.add(uint64_t{out.fault_code});
      hash.add(uint64_t{out.fault_id});
      hash.add(uint64_t{out.fault_cell});
      hash.add(static_cast<uint64_t>(out.fault_number));
      at(PortGroup::fault) = hash.value();
    }
    Hash links;
    links.add(static_cast<uint64_t>(out.ready << 8 | out.valid));
    for (size_t f = 0; f < held_.size(); ++f) {
      if ((out.valid >> f & 1) == 0) continue;
      links.add(uint64_t{held_[f].end});
      add(links, held_[f].payload);
    }
    at(PortGroup::links) = links.value();
    Hash acks;
    acks.add(static_cast<uint64_t>(out.beat_errors << 8 | out.ack_errors));
    // A flat node has no ports along z.
    for (size_t f = 0; f < out.ack.size(); ++f)
      if (has_link_ >> f & 1) acks.add(uint64_t{out.ack[f]});
    at(PortGroup::acks) = acks.value();
    return s;
  }

  const std::unique_ptr<NodeModel> node_;
  const uint8_t has_link_;
  std::array<emu::Beat, kFaces> held_{};  // the link registers
};

class Recorder final : public Watcher {
 public:
  Recorder(std::unique_ptr<NodeModel> node, uint8_t has_link, std::vector<Shown>& record)
      : Watcher(std::move(node), has_link), record_(record) {}

 private:
  void see(const Shown& shown) override { record_.push_back(shown); }
  std::vector<Shown>& record_;
};

class Comparer final : public Watcher {
 public:
  Comparer(std::unique_ptr<NodeModel> node, uint8_t has_link, const std::vector<Shown>& expected,
           uint64_t& cycles)
      : Watcher(std::move(node), has_link), expected_(expected), cycles_(cycles) {}

 private:
  void see(const Shown& shown) override {
    const size_t now = now_++;
    if (now >= expected_.size())
      throw std::runtime_error(fmt::format("cycle {} after reset {}{}: that run was over", now, kPortsDiffer,
                                           to_string(PortGroup::phases)));
    for (size_t g = 0; g < shown.size(); ++g)
      if (shown[g] != expected_[now][g])
        throw std::runtime_error(fmt::format("cycle {} after reset {}{}", now, kPortsDiffer,
                                             to_string(static_cast<PortGroup>(g))));
    ++cycles_;
  }
  const std::vector<Shown>& expected_;
  uint64_t& cycles_;
  size_t now_ = 0;
};

}  // namespace

const char* to_string(PortGroup group) {
  constexpr const char* kNames[] = {"phases", "idle", "observe", "fault", "links", "acks"};
  return kNames[static_cast<size_t>(group)];
}

emu::NodeFactory recorded(emu::NodeFactory factory, PortRecord& record) {
  return [factory = std::move(factory), &record](uint32_t node, uint8_t has_link) {
    return std::make_unique<Recorder>(factory(node, has_link), has_link, record.at(node));
  };
}

emu::NodeFactory watched(emu::NodeFactory factory, const PortRecord& expected, uint64_t& cycles) {
  return [factory = std::move(factory), &expected, &cycles](uint32_t node, uint8_t has_link) {
    return std::make_unique<Comparer>(factory(node, has_link), has_link, expected.at(node), cycles);
  };
}

}  // namespace cuboct::test
