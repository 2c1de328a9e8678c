// SPDX-License-Identifier: MIT
// Which sources the program was built from.
#pragma once

namespace cuboct {

// The commit of the sources as `git describe` tells it, with "-dirty" where files differ from it; "unknown"
// where the sources are no git repository of their own. Written anew at each build by cli/commit.cmake.
const char* commit();

}  // namespace cuboct
