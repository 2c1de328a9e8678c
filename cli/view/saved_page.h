// SPDX-License-Identifier: MIT
// The page of a run: one that stands in a file with all that it shows, and one that asks a server for its
// frames.
#pragma once

#include <cstddef>
#include <string>

#include "cli/view/compared_runs.h"
#include "cli/view/stored_run.h"

namespace cuboct {

// Whether this build has the page: it needs three.js, which npm fetches.
bool has_view_page();

// MB that a saved page may have at most.
inline constexpr size_t kMostMegabytes = 2000;

// InputError, before anything is written, where the page would be larger than `limit` bytes; its hint names
// options that do. `every`: with which the run was read. Same run, same bytes.
std::string saved_page(const StoredRun& run, size_t limit, size_t every);
// Of two runs, without their machines.
std::string saved_page(const ComparedRuns& runs, size_t limit, size_t every);

// The page that asks.
std::string served_page();

}  // namespace cuboct
