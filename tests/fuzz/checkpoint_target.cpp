// SPDX-License-Identifier: MIT
// Checkpoints, journals and the progress of a study of elements: words with their hash made right, as whoever
// means harm would.
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "model/base/hash.h"
#include "model/run/checkpoint.h"
#include "model/run/element_progress.h"
#include "model/run/journal.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {
namespace {

constexpr size_t kHeadWords = 3;  // magic number, version, hash of the plan

std::vector<uint64_t> words_of(Bytes input) {
  std::vector<uint64_t> words(input.size() / 8);
  if (!words.empty()) std::memcpy(words.data(), input.data(), words.size() * 8);
  return words;
}

uint64_t hash_of(std::span<const uint64_t> words) {
  Hash hash;
  for (const uint64_t word : words) hash.add(word);
  return hash.value();
}

std::string file_of_words(const std::vector<uint64_t>& words, const std::string& name) {
  return file_of(Bytes(reinterpret_cast<const uint8_t*>(words.data()), words.size() * 8), name);
}

void read_checkpoint(const std::string& path, uint64_t plan, bool displaced, bool real) {
  CheckpointReader from(path, plan, displaced);
  if (real) {
    Body body;
    std::vector<uint64_t> kept;
    from.next(body, kept);
  } else {
    for (uint32_t k = 0; k < from.head().particles; ++k) from.next();
  }
}

}  // namespace

void take_checkpoint(Bytes input) {
  std::vector<uint64_t> words = words_of(input);
  if (words.size() < kHeadWords) return;
  const uint64_t plan = words[2];
  const WordMark end{words.size(), hash_of(words)};
  const std::string journal = file_of_words(words, "checkpoint.journal");
  for (const bool displaced : {false, true})
    refusing([&] {
      Trace trace;
      Journal from(journal, plan, displaced, end, trace);
      from.for_each_frame([](const RunState&) {});
    });
  words.back() = hash_of(std::span(words).first(words.size() - 1));
  const std::string checkpoint = file_of_words(words, "checkpoint");
  for (const bool displaced : {false, true})
    for (const bool real : {false, true})
      refusing([&] { read_checkpoint(checkpoint, plan, displaced, real); });
  refusing([&] { load_progress(checkpoint, plan); });
}

}  // namespace cuboct::fuzz
