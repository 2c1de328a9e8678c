// SPDX-License-Identifier: MIT
#include "model/program/rule_text.h"

#include <bit>

#include "model/base/hash.h"

namespace cuboct {
namespace {

class TextHash {
 public:
  void add(const std::string& text) {
    for (const char c : text) hash_.add(c);
    hash_.add(-1);
  }
  void add(const std::optional<Formula>& formula) { add(formula ? formula->text : std::string()); }
  void add(double value) { hash_.add(std::bit_cast<int64_t>(value)); }
  void add(const std::vector<RuleText::Field>& fields) {
    for (const RuleText::Field& field : fields) {
      add(field.name);
      hash_.add(static_cast<int64_t>(field.kind));
      add(field.start);
    }
  }
  void add(const std::vector<RuleText::Write>& writes) {
    for (const RuleText::Write& write : writes) add(write.name), add(write.is.text);
  }
  void add(const std::vector<RuleText::Round>& rounds) {
    hash_.add(static_cast<int64_t>(rounds.size()));
    for (const RuleText::Round& round : rounds) {
      for (const RuleText::Sum& sum : round.sums) add(sum.name), add(sum.is.text), add(sum.when);
      add(round.bonds);
      add(round.finishes);
    }
  }
  uint64_t value() const { return hash_.value(); }

 private:
  Hash hash_;
};

}  // namespace

uint64_t hash_of(const RuleText& text) {
  TextHash hash;
  hash.add(static_cast<double>(text.range));
  hash.add(text.still ? 1.0 : 0.0);
  for (const auto& [name, p] : text.parameters) hash.add(name), hash.add(p.value);
  for (const auto& [name, let] : text.lets) hash.add(name), hash.add(let.text);
  for (const RuleText::Table& table : text.tables) {
    hash.add(table.name);
    for (const auto* column : {&table.at, &table.value, &table.slope}) {
      hash.add(static_cast<double>(column->size()));
      for (const Formula& formula : *column) hash.add(formula.text);
    }
  }
  hash.add(text.reach);
  if (text.core) hash.add(text.core);
  hash.add(text.broken);
  hash.add(text.particle);
  hash.add(text.bond);
  hash.add(text.setup);
  hash.add(text.rounds);
  if (text.potential) hash.add(std::bit_cast<double>(text.potential->hash));
  return hash.value();
}

}  // namespace cuboct
