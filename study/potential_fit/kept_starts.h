// SPDX-License-Identifier: MIT
// What a fit of parameters has computed so far, in a file that survives the process.
#pragma once

#include <map>
#include <string>

#include "study/potential_fit/bond_fit.h"
#include "study/sweep/kept_lines.h"

namespace cuboct::bond_fit {

class KeptStarts {
 public:
  // DIR/starts.jsonl. Throws InputError where it is another study's, or no such file.
  KeptStarts(const std::string& directory, const BondStudy& study);

  // `number` of a start: 0 is BondStudy::from, 1 the first random one. Null: not there.
  const Found* start(int number) const;
  const Tried* trial(int number) const;
  void add(int number, Found found);
  void add(int number, Tried tried);
  void save() { kept_.save(); }

 private:
  std::map<int, Found> starts_;
  std::map<int, Tried> trials_;
  study::KeptLines kept_;
};

}  // namespace cuboct::bond_fit
