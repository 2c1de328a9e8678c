// SPDX-License-Identifier: MIT
// A rule of several rounds as data: what a particle and a bond hold, and what each round exchanges, sums and
// makes of the sums. An engine reads its arrays, its exchanges and its order of work from here; pages and
// `cuboct check` print it. docs/reference/rounds.md.
//
// A round is
//   exchange   neighbours get the particle fields `exchanged` of each other
//   pair term  each particle adds up `sums` over its bonds, which may change the bonds' own fields `updated`
//   finish     each particle makes its fields `made` of its sums
// The pair law is the rule of one round, and stays outside of this: its engines know it by heart.
#pragma once

#include <string>
#include <vector>

namespace cuboct {

// A named quantity of `numbers` components: 1 of a scalar, 3 of a vector, 6 of a symmetric tensor.
struct RuleField {
  std::string name;
  int numbers = 1;
  std::string unit;
  std::string what;       // one line for people
  bool of_bonds = false;  // so many for each bond that the particle has
};

struct RuleRound {
  std::string name;
  std::vector<std::string> exchanged;  // particle fields that the pair term reads of the other particle
  std::vector<RuleField> sums;         // that the pair term adds up, zero when the round begins
  std::vector<std::string> updated;    // bond fields that the pair term changes
  std::vector<std::string> made;       // particle fields that the finish makes
};

// Which particles have a bond.
enum class BondRange : unsigned char {
  reference,  // those within reach in the body as packed: bonds keep what they hold, and never form again
  current,    // those within reach now: bonds hold nothing of their own
};

struct RuleDeclaration {
  std::string name;
  BondRange bonds = BondRange::reference;
  std::vector<RuleField> constants;    // of a bond, never changed: what the reference body says of it
  std::vector<RuleField> bond;         // of a bond, kept from step to step
  std::vector<RuleField> particle;     // of a particle, besides its state
  std::vector<std::string> ready;      // of those, what is made of the state before the first round
  std::vector<RuleRound> rounds;       // in order
  std::vector<RuleField> shown = {};   // of a particle, for those who look at it: RoundsTerms::shown()
  std::vector<std::string> kept = {};  // particle fields that go on from step to step
  bool moves = true;                   // else no particle does, and no round makes a force
  bool noise = false;                  // its rounds draw random numbers, other ones in each step
};

// The field that the last round makes and the step adds to the momentum, N.
inline constexpr const char* kForceField = "force";

// Throws std::logic_error, with the name, where the declaration does not hold together: a name that is there
// twice or nowhere, a field that is exchanged before it is made, or never made; no round; a last round
// without force; bond fields of bonds that are not kept.
void check(const RuleDeclaration& declaration);

// Numbers of all fields together: of those that a particle has once, or of those that it has for each bond.
int numbers_of(const std::vector<RuleField>& fields, bool of_bonds = false);
// The field's place in the list. std::logic_error where there is none.
size_t place_of(const std::vector<RuleField>& fields, const std::string& name);

// Lines for people: the fields, and each round's work.
struct DeclarationLine {
  std::string name, text, note;
};
std::vector<DeclarationLine> lines_of(const RuleDeclaration& declaration);

}  // namespace cuboct
