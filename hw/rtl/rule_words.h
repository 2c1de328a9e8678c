// SPDX-License-Identifier: MIT
// Where the numbers of a rule of text stand in a node's words: in a particle, in a candidate, in a place of a
// row of bonds.
#pragma once

#include <string>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct {

// Bits of a word that stands in a vector of the text.
struct Slice {
  std::string of;
  int lsb = 0, bits = 0;
  bool is_signed = false;

  std::string text() const;
  // Extended or cut to `width`.
  std::string fit(int width) const;
};

// What stands in the place of some bits of a word.
struct Part {
  int lsb = 0, bits = 0;
  std::string text;
};
// `word` of `bits` bits with `parts`, which do not overlap, in their places: the text of a concatenation.
std::string with_parts(const std::string& word, int bits, std::vector<Part> parts, const char* between);

class RuleWords {
 public:
  // `plan`, of a rule of text, must outlive it.
  explicit RuleWords(const Plan& plan);

  const WordField& own_field(FieldKind kind, int axis = -1, int number = 0) const;
  // Of a particle that stands in `of`.
  Slice own(const std::string& of, FieldKind kind, int axis = -1, int number = 0) const;
  // Of a candidate: its positions, with signs, are lowest; then what each round reads of it, in turn.
  Slice other(const std::string& of, FieldKind kind, int axis = -1) const;
  // What a round, 0 the first, has of a field of the candidate's: as the last round sent it that did so.
  Slice other_number(const std::string& of, int number, int round) const;
  // Of the first place of a row of bonds.
  const WordField& bond_field(int number) const;

  // Of a particle's id: what others see of it lies below the id's end.
  int id_lsb() const { return own_field(FieldKind::id).lsb; }
  // Bits of an own particle that a pair reads.
  int pair_bits() const;
  const std::vector<WordField>& others() const { return others_; }  // of a candidate, behind its positions
  int candidate_bits() const { return candidate_bits_; }
  int later_bits() const { return later_bits_; }  // of a candidate: what all rounds but the first read
  int id_in_candidate() const { return other("", FieldKind::id).lsb; }

  int places() const { return places_; }          // of a row of bonds; 0: there are none
  int bond_lsb() const { return bond_lsb_; }      // of the row
  int place_bits() const { return place_bits_; }  // of a place: the partner's id, the kind, numbers
  int kind_bits() const { return kind_bits_; }
  // Where the numbers that rounds write begin in a place, and their bits.
  int numbers_lsb() const { return plan_.words.id_bits + kind_bits_; }
  int number_bits() const { return place_bits_ - numbers_lsb(); }

 private:
  const Plan& plan_;
  std::vector<WordField> others_;
  int candidate_bits_ = 0, later_bits_ = 0;
  int places_ = 0, bond_lsb_ = 0, place_bits_ = 0, kind_bits_ = 0;
};

}  // namespace cuboct
