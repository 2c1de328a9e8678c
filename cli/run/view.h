// SPDX-License-Identifier: MIT
// `cuboct run --view`: DIR/report.html shows the run while it goes, and is its report in the end.
#pragma once

#include <chrono>
#include <string>

#include "cli/command.h"
#include "model/trace/frame.h"

namespace cuboct {

// Opens a file or an address where there is a display, apart from this process, which may end before its
// browser.
bool open_in_browser(const std::string& address);

// Nothing here ends a run: what goes wrong is told once on stderr, and the run goes on without a page.
class LiveView {
 public:
  // Writes the page. `open`: in a browser, where there is a display; else the page's path is told.
  LiveView(std::string directory, const Loaded& loaded, uint64_t steps, bool open);
  ~LiveView();  // of a run that failed
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  // The newest frame. Drawing takes a tenth of the run's time at most: frames that come sooner are left out.
  void show(const Frame& frame);
  // Once the run's directory is whole.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  template <typename Work>
  void attempt(Work work);
  void write(const std::string& body, int refresh);
  void open_page() const;

  std::string path_, directory_, title_;
  const Loaded& loaded_;
  uint64_t steps_;
  bool failed_ = false, ended_ = false;
  Clock::time_point next_ = Clock::now();
};

}  // namespace cuboct
