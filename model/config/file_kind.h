// SPDX-License-Identifier: MIT
// The kinds of TOML files that users write, told by their top-level keys: a file given in the place of
// another kind is called what it is.
#pragma once

#include <string>

#include "model/base/error.h"
#include "model/config/config.h"

namespace cuboct {

enum class FileKind {
  scene,
  arch,
  rule,           // of a scene's rule
  study,          // of settings: cuboct explore
  machine_study,  // cuboct explore
  curve_fit,      // cuboct fit
  potential_fit,  // cuboct fit
  learn_study,    // cuboct learn
  element_study,  // cuboct multiscale
  technology,     // cuboct energy
  run_record,     // run.toml of a run's directory
};

// Throws InputError where the text is plainly of another kind than `wanted`:
//   coupon.toml:4:1: this is a scene, not a study of settings
//     hint: 'cuboct run coupon.toml' takes it
void refuse_other_kind(FileKind wanted, const std::string& text, const std::string& path);

// What `read` makes of the file's table. Where it refuses the file, another kind is told before all else.
template <typename Read>
auto read_kind(FileKind wanted, const std::string& text, const std::string& path, Read read) {
  try {
    return read(parse_config(text, path));
  } catch (const InputError&) {
    refuse_other_kind(wanted, text, path);
    throw;
  }
}
template <typename Read>
auto read_kind(FileKind wanted, const std::string& path, Read read) {
  return read_kind(wanted, read_config_text(path), path, read);
}

}  // namespace cuboct
