// SPDX-License-Identifier: MIT
// The file in which a study of macro-elements leaves its progress: words (model/run/word_file.h), whole or
// not there.
#pragma once

#include <string>
#include <vector>

#include "model/run/element_run.h"

namespace cuboct {

struct ElementProgressFile {
  std::vector<SetOutcome> done;
  ElementProgress now;
};

void save_progress(const std::string& path, uint64_t study, const ElementProgressFile& progress);
// What was saved, or nothing where there is no such file. InputError where it is of another study, or
// damaged.
ElementProgressFile load_progress(const std::string& path, uint64_t study);

}  // namespace cuboct
