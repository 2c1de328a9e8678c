// SPDX-License-Identifier: MIT
// What a run leaves where it is killed, interrupted or out of disk, and who may write into its directory.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <regex>

#include "model/base/directory_lock.h"
#include "model/base/error.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

// 256 particles; a frame of them is about 20 kB in each of a run's files.
constexpr const char* kScene = "scenes/lj_block.toml";

// A run in a process of its own, with the files that a Bench's answer has.
class Started {
 public:
  Started(const Bench& bench, const Strings& arguments, rlim_t file_limit = RLIM_INFINITY) : bench_(bench) {
    const std::string program = bench.path("bin/cuboct");
    std::vector<char*> argv{const_cast<char*>("cuboct")};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    dup2(open("/dev/null", O_RDONLY), 0);
    dup2(open(bench.path("out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), 1);
    dup2(open(bench.path("err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), 2);
    setenv("TMPDIR", bench.path("tmp").c_str(), 1);
    const rlimit limit{file_limit, file_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
    if (chdir(CUBOCT_SOURCE_DIR) == 0) execv(program.c_str(), argv.data());
    _exit(127);
  }
  ~Started() {
    if (pid_ < 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;

  pid_t pid() const { return pid_; }
  bool runs() const {
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0;
  }
  void signal(int number) const { kill(pid_, number); }
  Answer finish() {
    int status = 0;
    rusage usage{};
    wait4(pid_, &status, 0, &usage);
    pid_ = -1;
    memory_ = usage.ru_maxrss;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), contents(bench_.path("out")),
            contents(bench_.path("err"))};
  }
  long memory() const { return memory_; }  // kB, at most

 private:
  const Bench& bench_;
  pid_t pid_;
  long memory_ = 0;
};

std::string state_of(const std::string& directory) {
  std::smatch found;
  const std::string text = contents(directory + "/run.toml");
  return std::regex_search(text, found, std::regex("state = ['\"]([a-z]*)['\"]")) ? found[1].str()
                                                                                  : "no state";
}

// Steps of the frames of frames.xyz, each of which must be whole.
std::vector<uint64_t> xyz_steps(const std::string& directory) {
  std::vector<uint64_t> steps;
  std::ifstream in(directory + "/frames.xyz");
  for (std::string line; std::getline(in, line);) {
    const int particles = std::stoi(line);
    std::getline(in, line);
    steps.push_back(std::stoull(line.substr(line.find("Step=") + 5)));
    for (int k = 0; k < particles; ++k) {
      EXPECT_TRUE(std::getline(in, line));
      EXPECT_EQ(std::count(line.begin(), line.end(), ' '), 19) << line;
    }
  }
  return steps;
}

// Processes whose program stands in the bench, and is called so.
std::vector<std::string> processes(const Bench& bench, const std::string& name = {}) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::error_code none;
    const std::string program = fs::read_symlink(entry.path() / "exe", none).string();
    if (program.starts_with(bench.path("bin/" + name)))
      found.push_back(entry.path().filename().string() + " " + program);
  }
  return found;
}

class NothingLost : public testing::Test {
 protected:
  NothingLost() : bench_(true) {
    fs::create_directory(bench_.path("tmp"));
    fs::copy(CUBOCT_LATTICE, bench_.path("bin/cuboct-lattice"));
  }

  std::string dir() const { return bench_.path("dir"); }
  Strings run(const Strings& more) const {
    Strings all{"run", kScene, "--quiet", "--out", dir()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expect_refusal(const std::string& hint) const {
    const Answer again = bench_.cuboct(run({"--steps", "3"}));
    EXPECT_EQ(again.code, 2);
    EXPECT_EQ(again.err, dir() + " holds a run that did not end\n  hint: " + hint + "\n");
    EXPECT_EQ(again.out, "");
  }
  void expect_force() const {
    const Answer answer = bench_.cuboct(run({"--steps", "3", "--force"}));
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(state_of(dir()), "finished");
    EXPECT_EQ(xyz_steps(dir()), (std::vector<uint64_t>{0, 3}));
    EXPECT_EQ(read_trace(dir() + "/trace.h5").steps(), 3u);
    for (const char* name : {"trace.part.h5", "rasters.part.h5", "checkpoint", "checkpoint.journal",
                             "checkpoint.tmp", ".lock", ".reserved"})
      EXPECT_FALSE(fs::exists(dir() + "/" + name)) << name;
  }

  // Lattice's ranks say so by a file.
  bool ranks_step() const {
    for (const auto& entry : fs::directory_iterator(bench_.path("tmp")))
      if (fs::exists(entry.path() / "lattice.h5.begun")) return true;
    return false;
  }

  Bench bench_;
};

constexpr const char* kHint = "another --out keeps it; --force begins anew in its place";
constexpr const char* kResume = "--resume goes on with it; --force begins anew in its place";

struct Engine {
  const char* name;
  Strings options;
};
std::ostream& operator<<(std::ostream& out, const Engine& engine) { return out << engine.name; }

class OfEngine : public NothingLost, public testing::WithParamInterface<Engine> {
 protected:
  Strings run(const Strings& more) const {
    Strings all = NothingLost::run(GetParam().options);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  bool is_ranks() const { return std::string(GetParam().name) == "ranks"; }
  bool is_false() const { return std::string(GetParam().name) == "systemc"; }
};

std::string name_of(const testing::TestParamInfo<Engine>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Engines, OfEngine,
                         testing::Values(Engine{"lattice", {"--engine", "lattice"}},
                                         Engine{"ranks", {"--engine", "lattice", "--ranks", "2"}},
                                         Engine{"golden", {"--engine", "golden"}},
                                         Engine{"reference", {"--engine", "reference"}},
                                         Engine{"systemc", {"--engine", "systemc"}}),
                         name_of);

TEST_F(NothingLost, AFileThatNoRunLeftStays) {
  fs::create_directory(dir());
  std::ofstream(dir() + "/frames.xyz") << "mine";
  const Answer answer = bench_.cuboct(run({"--steps", "3"}));
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err, dir() +
                            " holds a file frames.xyz that no run left\n  hint: another --out keeps it; "
                            "--force puts a run's in its place\n");
  EXPECT_EQ(fs::file_size(dir() + "/frames.xyz"), 4u);
  expect_force();
}

// No file may grow beyond 1500 kB: frames.xyz is the first to reach that, and the only one.
TEST_P(OfEngine, AFullDiskCostsWhatDoesNotFit) {
  if (is_ranks()) GTEST_SKIP() << "files of Open MPI itself need more";
  Started started(bench_, run({"--steps", "80", "--frame-every", "1"}), 1500 << 10);
  const Answer answer = started.finish();
  EXPECT_EQ(answer.code, 2) << answer.err;
  const auto kept = xyz_steps(dir());
  EXPECT_GT(kept.size(), 10u);
  EXPECT_LT(kept.size(), 81u);
  for (size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(kept[k], k);
  const std::string what = "cannot write " + dir() + "/frames.xyz: File too large";
  const std::string end = fmt::format("frames.xyz has {}\n", kept.size());
  EXPECT_TRUE(answer.err.starts_with("warning: " + what + "; the run goes on\n" + what + "; of 81 frames "))
      << answer.err;
  EXPECT_TRUE(answer.err.ends_with(end)) << answer.err;
  EXPECT_NE(answer.out.find("ended"), std::string::npos);  // the summary came
  // The rest is there.
  EXPECT_EQ(state_of(dir()), "incomplete");
  EXPECT_FALSE(contents(dir() + "/summary.json").empty());
  const Trace trace = read_trace(dir() + "/trace.h5");
  EXPECT_EQ(trace.steps(), 80u);
  ASSERT_FALSE(trace.curves.empty());
  EXPECT_EQ(trace.curves.back().step.back(), 80u);
  EXPECT_TRUE(fs::exists(dir() + "/frames_000080.vtp"));
  EXPECT_EQ(bench_.cuboct({"picture", dir(), "--out", bench_.path("p.png")}).code, 0);
  expect_refusal(kHint);
  expect_force();
}

// Not even what a trace holds besides frames would fit.
TEST_P(OfEngine, ADiskThatIsFullBeforeIsFoundBeforeTheFirstStep) {
  if (is_false()) GTEST_SKIP() << "the false one does all steps before the first";
  if (is_ranks()) GTEST_SKIP() << "files of Open MPI itself need more";
  Started started(bench_, run({"--steps", "1000000"}), 300 << 10);
  const Answer answer = started.finish();
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with("cannot write into " + dir() +
                                     ": File too large\n  hint: hashes, curves and summary alone may take "))
      << answer.err;
  EXPECT_EQ(answer.out, "");
  EXPECT_EQ(state_of(dir()), "no state");
}

TEST_P(OfEngine, AKillLeavesTheFramesSoFar) {
  if (is_false()) GTEST_SKIP() << "the false one does all steps before the first";
  Started started(bench_, run({"--steps", "1000000", "--frame-every", "5"}));
  ASSERT_TRUE(comes([&] { return fs::exists(dir() + "/frames_000004.vtp"); }));
  started.signal(SIGKILL);
  EXPECT_EQ(started.finish().code, -SIGKILL);
  std::vector<uint64_t> kept;
  // The file may end within the frame that was being written: what is before it is whole.
  const std::string text = contents(dir() + "/frames.xyz");
  const auto lines = std::count(text.begin(), text.end(), '\n');
  EXPECT_GE(lines, 4 * 258);
  EXPECT_EQ(state_of(dir()), "running");
  EXPECT_FALSE(fs::exists(dir() + "/trace.h5"));
  EXPECT_TRUE(fs::exists(dir() + "/trace.part.h5") || std::string(GetParam().name) == "reference");
  expect_refusal(kHint);
  expect_force();
}

TEST_P(OfEngine, SigtermEndsItAsCtrlCDoes) {
  if (is_false()) GTEST_SKIP() << "the false one knows no signals";
  Started started(bench_, run({"--steps", "10000000", "--frame-every", "100", "--anyway"}));
  ASSERT_TRUE(comes([&] { return fs::exists(dir() + "/frames_000001.vtp") || !started.runs(); }));
  started.signal(SIGTERM);
  const Answer answer = started.finish();
  if (answer.err.find("MPI") != std::string::npos) GTEST_SKIP() << answer.err;
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "interrupted\n");
  const Trace trace = read_trace(dir() + "/trace.h5");
  EXPECT_GT(trace.steps(), 0u);
  const std::string said = fmt::format("after {} of 10000000 steps", trace.steps());
  EXPECT_NE(contents(dir() + "/summary.json")
                .find("\"ended\": {\"value\": \"interrupted\", \"note\": \"" + said + "\"}"),
            std::string::npos)
      << contents(dir() + "/summary.json");
  EXPECT_NE(answer.out.find(said), std::string::npos);
  EXPECT_EQ(state_of(dir()), "interrupted");
  EXPECT_EQ(xyz_steps(dir()).back(), trace.steps());
  expect_refusal(kHint);
  expect_force();
}

#ifdef CUBOCT_SYSTEMC
// Of SystemC the trace holds the steps that all nodes have done: golden's.
TEST_F(NothingLost, SigtermEndsSystemcToo) {
  fs::remove(bench_.path("bin/cuboct-systemc"));
  fs::copy(CUBOCT_SYSTEMC, bench_.path("bin/cuboct-systemc"));
  Started started(bench_,
                  run({"--engine", "systemc", "--steps", "1000000", "--frame-every", "1", "--anyway"}));
  ASSERT_TRUE(comes([&] { return fs::exists(dir() + "/frames_000001.vtp"); }));
  started.signal(SIGTERM);
  const Answer answer = started.finish();
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "interrupted\n");
  EXPECT_EQ(state_of(dir()), "interrupted");
  const Trace trace = read_trace(dir() + "/trace.h5");
  ASSERT_GT(trace.steps(), 0u);
  EXPECT_EQ(trace.frames.back().step, trace.steps());
  expect_refusal(kHint);
  ASSERT_EQ(
      bench_.cuboct(run({"--engine", "golden", "--steps", std::to_string(trace.steps()), "--force"})).code,
      0);
  EXPECT_EQ(read_trace(dir() + "/trace.h5").state_hash, trace.state_hash);
}
#endif

// While the first runs: refused at once, by name. Its files are not touched.
TEST_P(OfEngine, TwoRunsIntoOneDirectoryAreOne) {
  Started started(bench_, run({"--steps", "10000000", "--anyway"}));
  ASSERT_TRUE(comes([&] { return !contents(dir() + "/.lock").empty(); }));
  for (const Strings& more : {Strings{}, Strings{"--force"}}) {
    Strings arguments = run({"--steps", "3"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Answer second = Bench(true).cuboct(arguments);
    EXPECT_EQ(second.code, 2);
    EXPECT_EQ(second.err, fmt::format("{} is in use by process {}, 'cuboct run'\n"
                                      "  hint: another --out, or wait for its end\n",
                                      dir(), started.pid()));
  }
  EXPECT_TRUE(started.runs());
}

TEST_F(NothingLost, NoCommandWritesIntoADirectoryInUse) {
  ASSERT_EQ(bench_.cuboct(run({"--steps", "3"})).code, 0);
  const Strings before{contents(dir() + "/trace.h5"), contents(dir() + "/summary.json")};
  const std::vector<Strings> commands{
      {"run", kScene, "--steps", "4", "--out", dir()},
      {"run", kScene, "--steps", "4", "--engine", "fpga", "--port", "/dev/null", "--out", dir()},
      {"run", kScene, "--steps", "4", "--engine", "rtl", "--out", dir()},
      {"run", kScene, "--steps", "4", "--engine", "gpu", "--out", dir()},
      {"crosscheck", kScene, "--steps", "1", "--engines", "golden,lattice", "--out", dir()},
#ifdef CUBOCT_HAS_STUDIES
      {"explore", "scenes/studies/block.toml", "--no-speed", "--out", dir()},
      {"stability", "scenes/undamped_block.toml", "--maps", dir()},
#endif
#ifdef CUBOCT_HAS_FITS
      {"fit", "scenes/studies/fit_bar.toml", "--out", dir()},
#endif
      {"report", dir()},
      {"picture", dir()}};
  const std::string expected = fmt::format(
      "{} is in use by process {}, 'a test'\n  hint: another --out, or wait for its end\n", dir(), getpid());
  {
    const DirectoryLock lock(dir(), "a test");
    for (const Strings& arguments : commands) {
      const Answer answer = bench_.cuboct(arguments);
      EXPECT_EQ(answer.code, 2) << arguments[0];
      EXPECT_EQ(answer.err, expected) << arguments[0];
    }
    const std::string project = bench_.path("project");
    const DirectoryLock other(project, "a test");
    const Answer answer = bench_.cuboct({"emit", kScene, "--out", project});
    EXPECT_EQ(answer.code, 2);
    EXPECT_NE(answer.err.find(" is in use by process "), std::string::npos) << answer.err;
  }
  EXPECT_EQ(before, (Strings{contents(dir() + "/trace.h5"), contents(dir() + "/summary.json")}));
  EXPECT_FALSE(fs::exists(bench_.path("project")));  // made for nothing
  EXPECT_EQ(bench_.cuboct({"report", dir()}).code, 0);
}

// No directory holds files of two runs.
TEST_F(NothingLost, TheFilesOfTheRunBeforeGo) {
  ASSERT_EQ(bench_.cuboct(run({"--steps", "4", "--frame-every", "1"})).code, 0);
  ASSERT_TRUE(fs::exists(dir() + "/frames_000004.vtp"));
  ASSERT_EQ(bench_.cuboct(run({"--steps", "3", "--no-states"})).code, 0);
  Strings names;
  for (const auto& entry : fs::directory_iterator(dir())) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (Strings{"plan.txt", "rasters.h5", "run.toml", "summary.json", "trace.h5"}));
}

// A lock is its process's: it goes with it, whatever stays on the disk.
TEST_F(NothingLost, ADeadProcessLocksNothing) {
  fs::create_directory(dir());
  std::ofstream(dir() + "/.lock") << "process 1, 'cuboct run'\n";
  EXPECT_EQ(bench_.cuboct(run({"--steps", "3"})).code, 0);
  EXPECT_FALSE(fs::exists(dir() + "/.lock"));
}

TEST_F(NothingLost, AnUnfinishedRunGoesOnOrIsKept) {
  // Killed before it left a checkpoint, then behind one.
  const Strings slow{"--steps", "10000000", "--checkpoint-every", "1 h"};
  {
    Started started(bench_, run(slow));
    ASSERT_TRUE(comes([&] { return fs::exists(dir() + "/run.toml"); }));
  }
  expect_refusal(kHint);
  {
    Strings forced = run({"--steps", "10000000", "--checkpoint-every", "20 steps", "--force"});
    Started started(bench_, forced);
    ASSERT_TRUE(comes([&] { return fs::exists(dir() + "/checkpoint"); }));
  }
  expect_refusal(kResume);
  fs::remove(dir() + "/trace.part.h5");
  {
    Started started(bench_, run({"--steps", "10000000", "--checkpoint-every", "1 h", "--resume"}));
    ASSERT_TRUE(comes([&] { return fs::exists(dir() + "/trace.part.h5"); }));
    started.signal(SIGTERM);
    EXPECT_EQ(started.finish().code, 1);
  }
  EXPECT_EQ(state_of(dir()), "interrupted");
  expect_refusal(kResume);
  expect_force();
  ASSERT_EQ(bench_.cuboct(run({"--steps", "5"})).code, 0);  // what came to its end may be replaced
}

// Of checkpoints that no longer fit the last good one stays, and the run comes to its end.
TEST_F(NothingLost, AFullDiskCostsCheckpointsAndNotTheRun) {
  Started started(bench_, run({"--steps", "100", "--frame-every", "1", "--checkpoint-every", "1 steps"}),
                  1100 << 10);
  const Answer answer = started.finish();
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("warning: cannot write " + dir() +
                            "/checkpoint.journal: File too large; no checkpoint from step "),
            std::string::npos)
      << answer.err;
  EXPECT_EQ(read_trace(dir() + "/trace.h5").steps(), 100u);
  EXPECT_TRUE(fs::exists(dir() + "/checkpoint"));
  ASSERT_EQ(bench_.cuboct(run({"--steps", "100", "--frame-every", "1", "--resume"})).code, 0);
  EXPECT_EQ(state_of(dir()), "finished");
  EXPECT_EQ(xyz_steps(dir()).size(), 101u);
  EXPECT_EQ(read_trace(dir() + "/trace.h5").frames.size(), 101u);
}

// Four times the frames in the same memory.
TEST_F(NothingLost, MemoryDoesNotGrowWithFrames) {
  for (const char* engine : {"lattice", "golden", "reference"}) {
    std::vector<long> memory;
    for (const char* every : {"100", "1"}) {
      Started started(bench_, run({"--steps", "400", "--frame-every", every, "--engine", engine, "--force"}));
      ASSERT_EQ(started.finish().code, 0);
      memory.push_back(started.memory());
    }
    // 400 frames of 256 particles are 9 MB of states and 7 MB of frames in real numbers.
    EXPECT_LT(memory[1], memory[0] + 10000) << engine;
  }
}

TEST_F(NothingLost, AFullFileSystemIsAFullDisk) {
  const std::string disk = bench_.path("disk");
  fs::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=2m") != 0)
    GTEST_SKIP() << "no right to mount a file system";
  for (const Strings& more : {Strings{}, Strings{"--ranks", "2"}}) {
    Strings arguments{"run", kScene,    "--steps",  "100",   "--frame-every",
                      "1",   "--force", "--anyway", "--out", disk + "/dir"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Started started(bench_, arguments);
    const Answer answer = started.finish();
    if (answer.err.find("MPI") != std::string::npos) continue;
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_NE(answer.err.find(": No space left on device; of 101 frames trace.h5 has "), std::string::npos)
        << answer.err;
    EXPECT_NE(answer.out.find("particle-steps/s"), std::string::npos);
    const Trace trace = read_trace(disk + "/dir/trace.h5");
    EXPECT_EQ(trace.steps(), 100u);
    EXPECT_GT(trace.frames.size(), 5u);
    EXPECT_EQ(trace.curves.back().step.back(), 100u);
    EXPECT_GT(xyz_steps(disk + "/dir").size(), 5u);
    EXPECT_TRUE(fs::exists(disk + "/dir/summary.json"));
    EXPECT_EQ(state_of(disk + "/dir"), "incomplete");
  }
  umount(disk.c_str());
}

TEST_F(NothingLost, ADirectoryThatCannotBeMadeIsFoundFirst) {
  std::ofstream(bench_.path("file")) << "x";
  const std::string below = bench_.path("file/below");
  const Answer answer = bench_.cuboct({"run", kScene, "--steps", "1000000", "--out", below});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err, "cannot make the directory " + below + ": Not a directory\n");
}

// Nothing else of the run is lost with whoever reads the summary.
TEST_F(NothingLost, AReaderThatGoesAwayCostsTheSummaryAlone) {
  const std::string command =
      fmt::format("cd {}; {} run {} --quiet --steps 5 --out {} 2>{} | :; exit ${{PIPESTATUS[0]}}",
                  CUBOCT_SOURCE_DIR, bench_.path("bin/cuboct"), kScene, dir(), bench_.path("err"));
  const int status = std::system(("bash -c '" + command + "'").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(contents(bench_.path("err")), "");
  EXPECT_EQ(read_trace(dir() + "/trace.h5").steps(), 5u);
  EXPECT_EQ(state_of(dir()), "finished");
}

class Ranks : public NothingLost {};

// One of them dies; then the command, while they step, and while they start.
TEST_F(Ranks, OutliveNobody) {
  if (bench_.cuboct({"run", kScene, "--steps", "1", "--ranks", "2"}).code != 0) GTEST_SKIP() << "no MPI";
  {
    Started started(bench_, run({"--steps", "10000000", "--ranks", "2", "--force"}));
    ASSERT_TRUE(comes([&] { return ranks_step(); }));
    kill(std::stoi(processes(bench_, "cuboct-lattice").at(0)), SIGKILL);
    const Answer answer = started.finish();
    EXPECT_EQ(answer.code, 1);
    EXPECT_EQ(answer.err, "a rank was ended by signal 9 (Killed)\n");
  }
  for (const int signal : {SIGKILL, SIGTERM, SIGHUP})
    for (const size_t ranks : {0u, 1u, 4u}) {
      if (signal != SIGKILL && ranks != 4)
        continue;  // a signal that can be caught is the same to those that start
      // What a killed one left: its daemon may be taking it away just now.
      ASSERT_TRUE(comes([&] {
        std::error_code busy;
        fs::remove_all(bench_.path("tmp"), busy);
        return !fs::exists(bench_.path("tmp"), busy);
      }));
      fs::create_directory(bench_.path("tmp"));
      Started started(bench_, run({"--steps", "10000000", "--ranks", "4", "--force"}));
      // With so many ranks there; the fifth is cuboct.
      ASSERT_TRUE(comes([&] { return processes(bench_).size() >= ranks + 1; }));
      if (ranks == 4) {
        ASSERT_TRUE(comes([&] { return ranks_step(); }));
      }
      started.signal(signal);
      started.finish();
      EXPECT_TRUE(comes([&] { return processes(bench_).empty(); })) << signal << " " << ranks;
    }
}

// Fewer steps than the checkpoint has: the run that was cut keeps its trace, its frames and its summary.
TEST_F(NothingLost, AResumeThatIsRefusedLeavesAllAsItWas) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  const auto files = [&] {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(out))
      all[entry.path().filename()] = contents(entry.path());
    return all;
  };
  std::vector<std::string> run{
      "run",        "scenes/lj_block.toml", "--quiet", "--out",   out,      "--checkpoint-every",
      "1000 steps", "--frame-every",        "100000",  "--steps", "1000000"};
  EXPECT_EQ(bench.cuboct(run, there(out + "/checkpoint")).code, 1);
  const auto before = files();
  EXPECT_EQ(before.count("trace.h5") + before.count("summary.json") + before.count("rasters.h5"), 3U);
  run.back() = "50";
  run.push_back("--resume");
  const Answer refused = bench.cuboct(run);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find(" was made with more steps: it is at step "), std::string::npos) << refused.err;
  EXPECT_TRUE(files() == before);
}

}  // namespace
}  // namespace cuboct::test
