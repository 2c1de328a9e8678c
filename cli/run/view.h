// SPDX-License-Identifier: MIT
// `cuboct run --view`: the page of `cuboct view`, of this run.
#pragma once

#include <optional>
#include <string>

#include "model/base/process.h"

namespace cuboct {

// Opens a file or an address where there is a display, apart from this process, which may end before its
// browser.
bool open_in_browser(const std::string& address);

// A `cuboct view` that follows the run in a directory. Nothing here ends a run: what goes wrong is told once
// on stderr, and the run goes on without a page.
class RunPage {
 public:
  // The directory is locked, and has no frame yet. `opens`: in a browser, where there is a display. The
  // address is told on stderr.
  RunPage(const std::string& directory, bool opens);

  // Once the directory is whole: its report, DIR/report.html.
  void report() const;
  // Once the directory is let go: until Ctrl-C, if somebody has opened the page. `by_page`: the run was
  // interrupted by it, and not by Ctrl-C.
  void wait(bool by_page);

 private:
  Scratch scratch_;
  std::string directory_;
  std::optional<Process> process_;
};

}  // namespace cuboct
