// SPDX-License-Identifier: MIT
#include "study/machines/peers.h"

#include "model/config/config.h"

namespace cuboct::study {
namespace {

constexpr Quantity kJoule{{{1, 2, -2}}, "an energy", "40 nJ"};

Peer read_peer(const ConfigTable& table, const std::string& name) {
  Peer peer;
  peer.name = name;
  peer.what = table.at("what").string();
  const std::vector<std::string> kinds{"measured", "published", "power assumed"};
  peer.known = kinds[table.at("known").choice("kind of number", kinds)];
  peer.particles = table.number("particles", quantity::number, Range::positive());
  peer.rate = table.number("particle_steps_per_s", quantity::number, Range::positive());
  peer.joules.low = table.number("joules_low", kJoule, Range::positive());
  peer.joules.high = table.number("joules_high", kJoule, Range::positive());
  if (peer.joules.low > peer.joules.high) table.at("joules_low").fail("'joules_low' is above 'joules_high'");
  peer.source = table.at("source").string();
  if (peer.source.empty()) table.at("source").fail("a number without a source");
  table.done();
  return peer;
}

}  // namespace

std::vector<Peer> parse_peers(const std::string& text, const std::string& path) {
  const ConfigTable root = parse_config(text, path);
  std::vector<Peer> peers;
  for (const std::string& name : root.names()) peers.push_back(read_peer(root.at(name).table(), name));
  root.done();
  return peers;
}

}  // namespace cuboct::study
