// SPDX-License-Identifier: MIT
// Studies of every kind, and curves.
#include <string>

#include "cli/machine/technologies.h"
#include "hw/cost/technology.h"
#include "model/atoms/multiscale/element_study.h"
#include "study/law_fit/csv.h"
#include "study/law_fit/fit_study.h"
#include "study/learn/learn_study.h"
#include "study/machines/machine_study.h"
#include "study/potential_fit/bond_study.h"
#include "study/sweep/study.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {
namespace {

study::MachineNames names() {
  return {
      technology_named,
      [](Technology technology, const std::string& link) { return with_link(std::move(technology), link); },
      {"ice40", "ecp5"}};
}

}  // namespace

void take_study(Bytes input) {
  // The scenes that it names are those beside the studies of the tree.
  const std::string path = file_of(input, "study.toml");
  refusing([&] { study::read_study(path); });
  refusing([&] {
    if (study::is_machine_study(path)) study::read_machine_study(path, names());
  });
  refusing([&] { fit::read_fit(path); });
  refusing([&] { fit::read_csv(path); });
  refusing([&] { bond_fit::read_bond_study(path); });
  refusing([&] { learn::read_learn_study(path); });
  refusing([&] { read_element_study(path); });
}

}  // namespace cuboct::fuzz
