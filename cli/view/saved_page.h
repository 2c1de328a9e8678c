// SPDX-License-Identifier: MIT
// The page of a run: one that stands in a file with all that it shows, and one that asks a server for its
// frames.
#pragma once

#include <cstddef>
#include <string>

#include "cli/view/stored_run.h"

namespace cuboct {

// Whether this build has the page: it needs three.js, which npm fetches.
bool has_view_page();

// InputError, before anything is written, where the page would be larger than `limit` bytes. Same run, same
// bytes.
std::string saved_page(const StoredRun& run, size_t limit);

// The page that asks.
std::string served_page();

}  // namespace cuboct
