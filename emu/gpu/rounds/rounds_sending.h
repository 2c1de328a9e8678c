// SPDX-License-Identifier: MIT
// What slabs of either arithmetic send to one another: which particles, and to which places.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "emu/gpu/rounds/rounds_halo.h"

namespace cuboct::gpu {

// What goes to another slab: sent[first, first + count), to its places from `at` on.
struct RoundsSending {
  uint32_t to, first, count, at;
};

inline uint32_t sent_in_all(const std::vector<RoundsSending>& sendings) {
  return sendings.empty() ? 0 : sendings.back().first + sendings.back().count;
}

// Lists the own particles that `choose(slab, number)` sends to other slabs. The host waits for their counts.
template <class Slab, class Choose>
void list_sent(std::vector<std::unique_ptr<Slab>>& slabs, int count, int block, const Choose& choose) {
  using Choice = decltype(choose(*slabs[0], 0));
  for (int s = 0; s < count; ++s) {
    Slab& slab = *slabs[static_cast<size_t>(s)];
    slab.sent_count.zero(slab.stream);
    for_each(slab.stream, 0, slab.own, block,
             RoundsCountSent<Choice>{choose(slab, s), slab.sent_count.data()});
  }
  for (int s = 0; s < count; ++s) {
    Slab& slab = *slabs[static_cast<size_t>(s)];
    const std::vector<uint32_t> to = slab.sent_count.host(slab.stream, 0, kMostSlabs);
    std::vector<uint32_t> next;
    slab.sendings.clear();
    uint32_t first = 0;
    for (uint32_t other = 0; other < to.size(); ++other) {
      next.push_back(first);
      if (to[other] > 0) slab.sendings.push_back({other, first, to[other], 0});
      first += to[other];
    }
    if (slab.sent.size() < first) slab.sent.resize(first + first / 8);
    slab.sent_count.put(slab.stream, 0, next);
    for_each(slab.stream, 0, slab.own, block,
             RoundsListSent<Choice>{choose(slab, s), slab.sent_count.data(), slab.sent.data()});
  }
}

// Of each slab the others' particles that its bonds go to, by owner, in the order of ids. `own`: the ids of
// each slab; `each_partner(id, use)` calls use(other) for each bond.
template <class EachPartner>
std::vector<std::vector<std::vector<uint32_t>>> bonded_ghosts(const std::vector<std::vector<uint32_t>>& own,
                                                              const std::vector<uint32_t>& owner,
                                                              const EachPartner& each_partner) {
  std::vector<std::vector<std::vector<uint32_t>>> ghosts(own.size());
  for (size_t s = 0; s < own.size(); ++s) {
    ghosts[s].resize(own.size());
    for (const uint32_t id : own[s])
      each_partner(id, [&](uint32_t other) {
        if (owner[other] != s) ghosts[s][owner[other]].push_back(other);
      });
    for (std::vector<uint32_t>& of : ghosts[s]) {
      std::sort(of.begin(), of.end());
      of.erase(std::unique(of.begin(), of.end()), of.end());
    }
  }
  return ghosts;
}

// Lists what slab `s` sends as such ghosts. `place`: of an id in its slab. Returns the same with its ghosts,
// behind its own particles.
template <class Slab>
std::vector<uint32_t> list_ghosts(Slab& slab, size_t s, size_t own, std::vector<uint32_t> place,
                                  const std::vector<std::vector<std::vector<uint32_t>>>& ghosts) {
  std::vector<uint32_t> sent;
  for (uint32_t to = 0; to < ghosts.size(); ++to) {
    const std::vector<uint32_t>& of = ghosts[to][s];
    if (of.empty()) continue;
    slab.sendings.push_back({to, static_cast<uint32_t>(sent.size()), static_cast<uint32_t>(of.size()), 0});
    for (const uint32_t id : of) sent.push_back(place[id]);
  }
  slab.sent.set(slab.stream, sent);
  auto next = static_cast<uint32_t>(own);
  for (const std::vector<uint32_t>& of : ghosts[s])
    for (const uint32_t id : of) place[id] = next++;
  return place;
}

template <class Slab>
void wait_for_all(const std::vector<std::unique_ptr<Slab>>& slabs) {
  for (const auto& slab : slabs) slab->stream.synchronize();
}

// Makes room for what the slabs send, behind what each has, by `make_room(slab, particles, kept)`.
template <class Slab, class MakeRoom>
void place_sendings(std::vector<std::unique_ptr<Slab>>& slabs, const MakeRoom& make_room) {
  std::vector<size_t> all;
  for (auto& slab : slabs) all.push_back(slab->own);
  for (auto& slab : slabs)
    for (RoundsSending& sending : slab->sendings) {
      sending.at = static_cast<uint32_t>(all[sending.to]);
      all[sending.to] += sending.count;
    }
  const auto sends = [&](const Slab& from, const Slab& to) {
    return std::any_of(from.sendings.begin(), from.sendings.end(),
                       [&](const RoundsSending& sending) { return slabs[sending.to].get() == &to; });
  };
  for (auto& slab : slabs) {
    slab->beside.clear();
    for (auto& other : slabs)
      if (other != slab && (sends(*slab, *other) || sends(*other, *slab)))
        slab->beside.push_back(other.get());
  }
  // What is written there is written after this.
  wait_for_all(slabs);
  for (size_t s = 0; s < slabs.size(); ++s) {
    make_room(*slabs[s], all[s], slabs[s]->own);
    slabs[s]->all = static_cast<uint32_t>(all[s]);
  }
}

// A round begins when the slabs beside are done with the one before: what they send is there, and none still
// reads the ghosts that this one goes on to write. A step begins when all slabs are: what one of them told of
// the last step, such as that it is impossible, is known before the next writes over the state that it began
// with.
template <class Slab>
void begin_round(std::vector<std::unique_ptr<Slab>>& slabs, bool step) {
  for (auto& slab : slabs) {
    if (!step)
      for (const Slab* other : slab->beside) slab->stream.wait(other->done);
    else
      for (const auto& other : slabs)
        if (other != slab) slab->stream.wait(other->done);
  }
}

template <class Slab>
uint64_t ghosts_of(const std::vector<std::unique_ptr<Slab>>& slabs) {
  uint64_t ghosts = 0;
  for (const auto& slab : slabs) ghosts += slab->all - slab->own;
  return ghosts;
}

}  // namespace cuboct::gpu
