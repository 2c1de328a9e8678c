// SPDX-License-Identifier: MIT
// `cuboct run --view`: a page that follows the run, and never ends it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

const std::string kRefresh = "http-equiv=\"refresh\"", kPicture = "data:image/png;base64,iVBORw0KGgo";

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A browser that notes what it is asked to open.
void put_browser(const Bench& bench) {
  fs::create_directories(bench.path("browser"));
  std::ofstream(bench.path("browser/xdg-open")) << "#!/bin/sh\necho \"$1\" > " + bench.path("opened") + "\n";
  fs::permissions(bench.path("browser/xdg-open"), fs::perms::owner_all);
}

class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* now = std::getenv(name)) before_ = now;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() { setenv(name_, before_.c_str(), 1); }

 private:
  const char* name_;
  std::string before_;
};

TEST(View, FollowsTheRunAndEndsAsItsReport) {
  const Bench bench(false);
  put_browser(bench);
  const std::string page = bench.path("run/report.html");
  const Environment path("PATH", bench.path("browser") + ":" + std::getenv("PATH")), display("DISPLAY", ":7");
  // Until the page shows a picture, and is to be read again.
  const Answer ran = bench.cuboct({"run", "scenes/coupon.toml", "--steps", "10000000", "--frame-every",
                                   "1000", "--anyway", "--view", "--out", bench.path("run")},
                                  [&](pid_t) {
                                    const std::string now = contents(page);
                                    return has(now, kRefresh) && has(now, kPicture);
                                  });
  EXPECT_EQ(ran.code, 1) << ran.err;
  const std::string last = contents(page);
  EXPECT_FALSE(has(last, kRefresh));
  EXPECT_TRUE(has(last, kPicture) && has(last, "<h2>Run</h2>"));
  ASSERT_TRUE(comes([&] { return !contents(bench.path("opened")).empty(); }));
  EXPECT_EQ(contents(bench.path("opened")), page + "\n");
}

TEST(View, SaysItsPathWithoutADisplay) {
  const Bench bench(false);
  const Environment x("DISPLAY", ""), wayland("WAYLAND_DISPLAY", "");
  const Answer ran = bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "3", "--quiet", "--view",
                                   "--out", bench.path("run"), "--json"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.err, "view: " + bench.path("run/report.html") + "\n");
  EXPECT_EQ(ran.out[0], '{');
  EXPECT_EQ(bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "3", "--view"}).err,
            "--view needs --out DIR: without it nothing of the run is kept\n");
}

// No gnuplot, no page; the run is none the worse.
TEST(View, NeverEndsARun) {
  const Bench bench(false);
  const Environment path("PATH", bench.path("nothing")), display("DISPLAY", "");
  const Answer ran = bench.cuboct(
      {"run", "scenes/lj_block.toml", "--steps", "3", "--quiet", "--view", "--out", bench.path("run")});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "warning: --view shows no more: ")) << ran.err;
  EXPECT_FALSE(has(contents(bench.path("run/report.html")), kRefresh));
  EXPECT_TRUE(fs::exists(bench.path("run/trace.h5")));
}

}  // namespace
}  // namespace cuboct::test
