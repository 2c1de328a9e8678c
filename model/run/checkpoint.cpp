// SPDX-License-Identifier: MIT
#include "model/run/checkpoint.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

#include "model/base/error.h"
#include "model/base/output.h"
#include "model/run/journal.h"

namespace cuboct {
namespace {

constexpr uint64_t kCheckpointMagic = 0x5450434854424355;  // "UCBTHCPT"
constexpr uint64_t kCheckpointVersion = 3;
constexpr size_t kCounters = 3;  // words; of an engine that counts less they are 0

void put(WordWriter& out, const std::vector<Vec3>& list) {
  out.word(list.size());
  for (const Vec3& v : list)
    for (int axis = 0; axis < 3; ++axis) out.number(v[axis]);
}

std::vector<Vec3> take_vectors(WordReader& in) {
  std::vector<Vec3> list(in.count(3));
  for (Vec3& v : list)
    for (int axis = 0; axis < 3; ++axis) v[axis] = in.number();
  return list;
}

}  // namespace

void write_checkpoint(const std::string& path, const CheckpointHead& head, Engine& engine, bool displaced) {
  const std::string temporary = path + ".tmp";
  // Ranks send their particles: to the end, even where the disk is full.
  std::optional<WordWriter> out;
  std::optional<InputError> refused;
  const auto attempt = [&](const auto& write) {
    try {
      if (!refused) write();
    } catch (const InputError& error) {
      refused = error;
    }
  };
  attempt([&] {
    out.emplace(temporary);
    for (const uint64_t value :
         {kCheckpointMagic, kCheckpointVersion, head.plan_hash, head.step, uint64_t{head.particles},
          head.hash_every, uint64_t{head.cycles}, uint64_t{head.energies}})
      out->word(value);
    out->number(head.seconds);
    out->number(head.largest_speed);
    for (const int64_t p : head.momentum) out->word(static_cast<uint64_t>(p));
    for (size_t k = 0; k < kCounters; ++k)
      out->word(k < head.engine.counters.size() ? head.engine.counters[k] : 0);
    for (const uint64_t value : {head.journal.words, head.journal.hash}) out->word(value);
    put(*out, head.probes.latest);
    put(*out, head.probes.moved);
    out->word(head.engine.own.size());
    out->words(head.engine.own);
  });
  bool slots = false;
  engine.for_each_slot([&](const Particle& p) {
    slots = true;
    attempt([&] { put(*out, p, displaced); });
  });
  if (const Body* body = slots ? nullptr : engine.saved_body())
    attempt([&] {
      put(*out, body->x, body->v, body->u);
      const std::vector<uint64_t> kept = body->bonds ? body->bonds->kept : std::vector<uint64_t>();
      out->word(kept.size());
      out->words(kept);
    });
  attempt([&] {
    out->word(out->mark().hash);
    out->sync();
  });
  out.reset();
  if (refused) {
    discard(temporary);
    throw InputError(*refused);
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0)
    throw InputError(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
  sync_directory_of(path);
}

CheckpointReader::CheckpointReader(const std::string& path, uint64_t plan_hash, bool displaced)
    : path_(path), in_(path), displaced_(displaced) {
  constexpr uint64_t kLeast = 22;  // words of a checkpoint without particles
  if (in_.size() < 2 || in_.word() != kCheckpointMagic)
    throw InputError(fmt::format("{} is not a checkpoint", path));
  if (const uint64_t version = in_.word(); version != kCheckpointVersion)
    throw InputError(fmt::format("{} is a checkpoint of version {}; this program reads version {}", path,
                                 version, kCheckpointVersion));
  if (in_.size() < kLeast || in_.ragged())
    throw InputError(fmt::format("{} is damaged: it is not whole", path));
  while (in_.mark().words + 1 < in_.size()) in_.word();
  const uint64_t found = in_.mark().hash;
  if (const uint64_t said = in_.word(); said != found)
    throw InputError(
        fmt::format("{} is damaged: its words hash to {:016x}, it says {:016x}", path, found, said));

  in_.seek(2);
  head_.plan_hash = in_.word();
  if (head_.plan_hash != plan_hash)
    throw InputError(fmt::format("{} was made by plan {:016x}; this scene and machine give plan {:016x}",
                                 path, head_.plan_hash, plan_hash),
                     "resume with the scene, machine and program that wrote it");
  head_.step = in_.word();
  head_.particles = static_cast<uint32_t>(in_.word());
  head_.hash_every = in_.word();
  head_.cycles = in_.word() != 0;
  head_.energies = in_.word() != 0;
  head_.seconds = in_.number();
  head_.largest_speed = in_.number();
  for (int64_t& p : head_.momentum) p = static_cast<int64_t>(in_.word());
  for (size_t k = 0; k < kCounters; ++k) head_.engine.counters.push_back(in_.word());
  head_.journal.words = in_.word();
  head_.journal.hash = in_.word();
  head_.probes.latest = take_vectors(in_);
  head_.probes.moved = take_vectors(in_);
  head_.engine.own.resize(in_.count(1));
  in_.words(head_.engine.own);
  first_ = in_.mark().words;
}

void CheckpointReader::rewind() { in_.seek(first_); }

void CheckpointReader::next(Body& body, std::vector<uint64_t>& kept) {
  take_body(in_, head_.particles, displaced_, body);
  kept.resize(in_.count(1));
  in_.words(kept);
}

Particle CheckpointReader::next() { return take_particle(in_, displaced_); }

}  // namespace cuboct
