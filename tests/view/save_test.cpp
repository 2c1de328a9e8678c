// SPDX-License-Identifier: MIT
// `cuboct view` as a command: what it writes, and what it refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "model/base/directory_lock.h"
#include "model/base/text.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"
#include "tests/support/hostile.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

class View : public testing::Test {
 protected:
  // 256 particles, 5 frames.
  static void SetUpTestSuite() {
    bench_ = new Bench(false);
    const Answer ran = bench_->cuboct({"run", "scenes/lj_block.toml", "--steps", "20", "--frame-every", "5",
                                       "--quiet", "--frames", "none", "--out", bench_->path("run")});
    ASSERT_EQ(ran.code, 0) << ran.err;
  }
  static void TearDownTestSuite() { delete bench_; }

  static std::string path(const std::string& name) { return bench_->path(name); }
  static Answer view(std::vector<std::string> words) {
    words.insert(words.begin(), "view");
    return bench_->cuboct(words);
  }
  // Of the file that words save.
  static std::string saved(std::vector<std::string> words) {
    words.insert(words.end(), {"--save", path("page.html")});
    const Answer answer = view(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return contents(path("page.html"));
  }
  // Elements whose ids begin so: "b" of frames, "m" of the machine.
  static size_t blocks(const std::string& page, const std::string& id = "b") {
    size_t count = 0;
    for (size_t at = 0; (at = page.find("<script type=\"text/plain\" id=\"" + id, at)) != std::string::npos;
         ++at)
      ++count;
    return count;
  }
  static Bench* bench_;
};
Bench* View::bench_ = nullptr;

TEST_F(View, SavesTheSameBytesTwiceAndLoadsNothing) {
  const std::string page = saved({path("run")});
  EXPECT_TRUE(page == saved({path("run")}));
  EXPECT_EQ(blocks(page), 5U * 7);  // places, types, words, velocity, axial strain, strain, broken bonds
  EXPECT_NE(page.find("connect-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("The MIT License"), std::string::npos);
  for (const char* outside : {"<link rel=\"stylesheet", " src=\"", "@story@", "@script@", "@blocks@"})
    EXPECT_EQ(page.substr(0, page.find("<script>")).find(outside), std::string::npos) << outside;
}

TEST_F(View, SaysWhatItLeavesOut) {
  const Answer answer =
      view({path("run"), "--every", "3", "--particles", "100", "--save", path("part.html")});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("frames     3 of the run's 5\n"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("particles  100 of 256\n"), std::string::npos) << answer.out;
  const std::string page = contents(path("part.html"));
  EXPECT_EQ(blocks(page), 3U * 7);
  EXPECT_NE(page.find(R"("left_out":"of the run's 5")"), std::string::npos);
  EXPECT_NE(page.find(R"("particles":256)"), std::string::npos);
  EXPECT_NE(page.find(R"("shown":100)"), std::string::npos);
}

// Nothing is written, and the page of before stays.
TEST_F(View, RefusesAPageThatIsTooLarge) {
  const Answer ran = bench_->cuboct({"run", "scenes/coupon.toml", "--steps", "60", "--frame-every", "1",
                                     "--quiet", "--frames", "none", "--out", path("large")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  std::ofstream(path("old.html")) << "old";
  const Answer answer = view({path("large"), "--limit", "2", "--save", path("old.html")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with("the page would take some ")) << answer.err;
  EXPECT_NE(answer.err.find(" MB, above the 2 MB of --limit: 61 frames of "), std::string::npos)
      << answer.err;
  EXPECT_TRUE(contents(path("old.html")) == "old");
  // Each option that the hint names does.
  const std::string hint = answer.err.substr(answer.err.find("\n  hint: ") + 1);
  for (const std::string option : {"--every", "--particles", "--limit"}) {
    std::smatch found;
    ASSERT_TRUE(std::regex_search(hint, found, std::regex(option + " ([0-9]+)"))) << option << " in " << hint;
    std::vector<std::string> words{path("large"), option, found[1]};
    if (option != "--limit") words.insert(words.end(), {"--limit", "2"});
    const std::string page = saved(words);
    EXPECT_LE(page.size(), option == "--limit" ? 1000000 * std::stoul(found[1]) : 2000000U) << option;
  }
  // That of a part is of the run's frames, not of the part's.
  const Answer part = view({path("large"), "--every", "2", "--limit", "2", "--save", path("old.html")});
  std::smatch found;
  ASSERT_TRUE(std::regex_search(part.err, found, std::regex("--every ([0-9]+)"))) << part.err;
  EXPECT_GT(std::stoul(found[1]), 2U);
  saved({path("large"), "--every", found[1], "--limit", "2"});
}

TEST_F(View, RefusesOptionsThatDoNothing) {
  const auto refused = [](std::vector<std::string> words) {
    const Answer answer = view(std::move(words));
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    return answer.err;
  };
  EXPECT_EQ(refused({path("run"), "--limit", "5"}),
            "--limit is of a saved page: it goes with --save FILE.html\n");
  EXPECT_EQ(refused({path("run"), "--no-open", "--save", path("x.html")}),
            "--no-open is of a page that is served, and --save serves none\n");
  EXPECT_EQ(refused({path("run"), "--port", "0", "--save", path("x.html")}),
            "--port is of a page that is served, and --save serves none\n");
  for (const std::string option : {"--every", "--particles"})
    EXPECT_EQ(refused({"scenes/lj_block.toml", option, "5", "--no-open"}),
              option +
                  " is of a run that is over, and one that is started is not\n  hint: without it the "
                  "page follows the run\n");
}

// Nodes and what they held of any run in integers; how to record the rest.
TEST_F(View, TellsWhichCommandRecordsCycles) {
  const std::string page = saved({path("run")});
  EXPECT_EQ(blocks(page, "m-nodes"), 1U);
  EXPECT_EQ(blocks(page, "m-held"), 5U);
  EXPECT_EQ(blocks(page, "m-spans"), 0U);
  EXPECT_NE(page.find("scenes/lj_block.toml --engine lattice --cycles --out DIR\""), std::string::npos);
  const Answer ran = bench_->cuboct({"run", "scenes/lj_block.toml", "--steps", "2", "--engine", "reference",
                                     "--quiet", "--frames", "none", "--out", path("doubles")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string doubles = saved({path("doubles")});
  EXPECT_EQ(blocks(doubles, "m"), 0U);
  EXPECT_NE(doubles.find("\"missing\":\"A run in real numbers has no machine."), std::string::npos);
}

// All steps where they take a small part of the page, else those of frames and the last.
TEST_F(View, HasTheStepsOfFramesWhereAllAreTooLarge) {
  const Answer ran = bench_->cuboct({"run", "scenes/lj_block.toml", "--steps", "60", "--frame-every", "40",
                                     "--cycles", "--quiet", "--frames", "none", "--out", path("cycles")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string all = saved({path("cycles")}), part = saved({path("cycles"), "--limit", "1"});
  EXPECT_EQ(blocks(all, "m-spans"), 60U);
  EXPECT_NE(all.find("\"kept\":null"), std::string::npos);
  EXPECT_EQ(blocks(part, "m-spans"), 3U);
  EXPECT_NE(part.find("\"kept\":[0,40,59]"), std::string::npos);
}

TEST_F(View, RefusesPhasesOfAnotherMachine) {
  const Answer ran = bench_->cuboct({"run", "scenes/lj_block.toml", "--steps", "2", "--cycles", "--quiet",
                                     "--frames", "none", "--out", path("foreign")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  Trace trace = read_trace(path("foreign") + "/trace.h5");
  trace.nodes = 1;
  trace.cycles.resize(2 * trace.phases());
  write_trace(path("foreign") + "/trace.h5", trace);
  const Answer answer = view({path("foreign"), "--save", path("foreign.html")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with("the phases in the trace are of 1 nodes, and the scene's machine has "))
      << answer.err;
  EXPECT_FALSE(fs::exists(path("foreign.html")));
}

// The line that the command prints, and what the page begins with.
TEST_F(View, EqualRunsSaySo) {
  const Answer ran =
      bench_->cuboct({"run", "scenes/lj_block.toml", "--steps", "20", "--frame-every", "10", "--engine",
                      "golden", "--quiet", "--frames", "none", "--out", path("golden")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Answer answer = view({path("run"), "--with", path("golden"), "--save", path("both.html")});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("difference none in 3 frames of 256 particles\n"), std::string::npos)
      << answer.out;
  const std::string page = contents(path("both.html"));
  for (const char* told : {R"("first":null)", R"("particles":[0,0,0])", R"("besides":"")"})
    EXPECT_NE(page.find(told), std::string::npos) << told;
  EXPECT_EQ(blocks(page), 3U * 7);
  EXPECT_EQ(blocks(page, "w-b"), 3U * 7);
  EXPECT_EQ(blocks(page, "m-"), 0U);
}

// Other thermal velocities: from the first particle and the start on.
TEST_F(View, FirstDifferenceIsThatOfTheTraces) {
  std::string text = contents(CUBOCT_SOURCE_DIR "/scenes/lj_block.toml");
  text.replace(text.find("seed = 1"), 8, "seed = 2");
  std::ofstream(path("seed.toml")) << text;
  const Answer ran = bench_->cuboct({"run", path("seed.toml"), "--steps", "10", "--frame-every", "5",
                                     "--quiet", "--frames", "none", "--out", path("seed")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Answer answer = view({path("run"), "--with", path("seed"), "--save", path("both.html")});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("difference step 0, particle 0, velocity x: "), std::string::npos) << answer.out;
  const int64_t a = read_trace(path("run") + "/trace.h5").frames[0].particles[0].v[0];
  const int64_t b = read_trace(path("seed") + "/trace.h5").frames[0].particles[0].v[0];
  EXPECT_NE(contents(path("both.html")).find(fmt::format("\"words\":[\"{}\",\"{}\"]", a, b)),
            std::string::npos);
}

TEST_F(View, RefusesRunsOfDifferentBodies) {
  const auto refused = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--save", path("never.html")});
    const Answer answer = view(std::move(words));
    EXPECT_EQ(answer.code, 2);
    EXPECT_FALSE(fs::exists(path("never.html")));
    return answer.err;
  };
  const auto run = [](const std::string& scene, const std::string& out) {
    const Answer ran =
        bench_->cuboct({"run", scene, "--steps", "2", "--quiet", "--frames", "none", "--out", path(out)});
    ASSERT_EQ(ran.code, 0) << ran.err;
  };
  run("scenes/two_types.toml", "gels");
  EXPECT_EQ(refused({path("run"), "--with", path("gels")}),
            fmt::format("{} and {} are runs of different bodies: 256 and 270 particles\n  hint: --with takes "
                        "a run of the same particles, in another engine or on another machine\n",
                        path("run"), path("gels")));
  std::string text = contents(CUBOCT_SOURCE_DIR "/scenes/lj_block.toml");
  text.replace(text.find("dt = 0.004"), 10, "dt = 0.002");
  std::ofstream(path("slow.toml")) << text;
  run(path("slow.toml"), "slow");
  EXPECT_EQ(refused({path("run"), "--with", path("slow")}),
            fmt::format("the time step of {} is 0.004, and that of {} 0.002\n  hint: dt in [run] of the "
                        "scene; runs of one time step have frames at the same times\n",
                        path("run"), path("slow")));
  EXPECT_EQ(refused({path("run"), "--with", path("nothing")}),
            fmt::format("--with is of two runs that are over, and {1} is no directory\n  hint: cuboct run "
                        "SCENE --out DIR leaves one; then cuboct view {0} --with DIR\n",
                        path("run"), path("nothing")));
  DirectoryLock lock(path("slow"), "a test");
  EXPECT_EQ(refused({path("run"), "--with", path("slow")}),
            fmt::format("--with is of two runs that are over, and that in {} goes on\n  hint: it can be "
                        "compared once it has ended\n",
                        path("slow")));
}

// A socket at which somebody listens and nobody takes a connection: that of a page whose process is stopped.
class StoppedPage {
 public:
  explicit StoppedPage(const std::string& directory) : listener_(socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = directory + "/.view";
    EXPECT_LT(path.size(), sizeof address.sun_path);
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listener_, 0), 0);
  }
  ~StoppedPage() { close(listener_); }
  StoppedPage(const StoppedPage&) = delete;
  StoppedPage& operator=(const StoppedPage&) = delete;

 private:
  int listener_;
};

// It has place for one that waits: the run's first look fills that, and the rest find it full.
TEST_F(View, AStoppedPageDoesNotStopARun) {
  fs::create_directory(path("stuck"));
  const StoppedPage page(path("stuck"));
  const Answer ran = bench_->cuboct({"run", "scenes/lj_block.toml", "--steps", "20", "--frame-every", "1",
                                     "--quiet", "--frames", "none", "--out", path("stuck")});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(fs::exists(path("stuck") + "/trace.h5"));
  // Nor is it pushed aside by another page.
  DirectoryLock lock(path("stuck"), "a test");
  const Answer second = view({path("stuck"), "--no-open"});
  EXPECT_EQ(second.code, 2);
  EXPECT_EQ(second.err,
            fmt::format("another cuboct view follows {}\n  hint: its page shows the run\n", path("stuck")));
}

TEST_F(View, ABusyPortLeavesNoDirectory) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof here;
  auto* const address = reinterpret_cast<sockaddr*>(&here);
  ASSERT_EQ(bind(listener, address, size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, address, &size), 0);
  const Answer answer = view({"scenes/lj_block.toml", "--no-open", "--out", path("none"), "--port",
                              std::to_string(ntohs(here.sin_port))});
  close(listener);
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with("cannot listen on 127.0.0.1:")) << answer.err;
  EXPECT_FALSE(fs::exists(path("none")));
}

TEST_F(View, RefusesWhatIsNoRun) {
  EXPECT_EQ(view({path("nothing"), "--save", path("x.html")}).err,
            fmt::format("--save is of a run that is over, and {0} is no directory\n  hint: cuboct run {0} "
                        "--out DIR, then cuboct "
                        "view DIR --save {1}\n",
                        path("nothing"), path("x.html")));
  fs::create_directory(path("empty"));
  const Answer empty = view({path("empty"), "--save", path("x.html")});
  EXPECT_EQ(empty.code, 2);
  EXPECT_EQ(empty.err,
            fmt::format("{} holds no run: no file run.toml\n  hint: 'cuboct run SCENE --out DIR' makes one\n",
                        path("empty")));
  EXPECT_FALSE(fs::exists(path("x.html")));
  const Answer option = view({path("run"), "--steps", "5"});
  EXPECT_EQ(option.code, 2);
  EXPECT_EQ(option.err, fmt::format("--steps is of a run that is started, and {} is a directory\n  hint: "
                                    "cuboct view SCENE starts one\n",
                                    path("run")));
  const Answer scene = view({path("missing.toml"), "--no-open"});
  EXPECT_EQ(scene.code, 2);
  EXPECT_NE(scene.err.find("missing.toml"), std::string::npos) << scene.err;
}

// A scene that cannot be run is refused in the words of `cuboct run`, before there is an address.
TEST_F(View, TellsWhatTheRunRefuses) {
  std::ofstream(path("bad.toml")) << "title = \"bad\"\n[packing]\npitch = \"0.5 m m\"\n";
  const Answer run = bench_->cuboct({"run", path("bad.toml")}), seen = view({path("bad.toml"), "--no-open"});
  EXPECT_EQ(seen.code, 2);
  EXPECT_EQ(seen.out, "");
  EXPECT_EQ(seen.err, run.err);
  const Answer kept = view({path("bad.toml"), "--no-open", "--out", path("never")});
  EXPECT_EQ(kept.err, run.err);
  EXPECT_FALSE(fs::exists(path("never")));
}

TEST_F(View, HostileTextIsText) {
  std::ofstream(path("evil.toml")) << hostile_block() << R"([[material]]
name = "so<script>alert(1)<!--ft"
[run]
dt = 0.004
steps = 2
)";
  const Answer ran =
      bench_->cuboct({"run", path("evil.toml"), "--quiet", "--frames", "none", "--out", path("evil")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string page = saved({path("evil")});
  // Elements of our own alone: three of data and script beside the blocks.
  size_t scripts = 0;
  for (size_t at = 0; (at = page.find("<script", at)) != std::string::npos; ++at) ++scripts;
  EXPECT_EQ(scripts, blocks(page, "") + 2);
  EXPECT_NE(page.find("<title>" + html_text(hostile_text()) + "</title>"), std::string::npos);
  EXPECT_FALSE(take_loot());
}

}  // namespace
}  // namespace cuboct::test
