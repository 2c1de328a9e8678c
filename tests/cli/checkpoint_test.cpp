// SPDX-License-Identifier: MIT
// Checkpoints of cuboct-lattice: whatever ends a run, it can go on, and the trace tells no difference. What
// is not a whole checkpoint of this run is refused.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "model/base/hash.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

// That a program has taken.
double cpu_seconds(pid_t program) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(program, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// A run of a small block with everything that a checkpoint has to keep: forces that hold particles (so that
// displacements count), probes with a memory, energies, frames, cycles.
class Checkpoint : public testing::Test {
 protected:
  Checkpoint() {
    std::ofstream(path("block.toml"))
        << "title = \"Block\"\nunits = \"reduced\"\nmass = 1.0\n"
           "[packing]\npitch = \"relaxed\"\n[box]\ncells = [3, 3, 3]\nperiodic = \"xy\"\n"
           "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 1.5\n"
           "[regions]\nfloor = { shape = \"half_space\", point = [0, 0, 0.1], normal = [0, 0, 1] }\n"
           "[[constraint]]\nname = \"spring\"\nkind = \"held_by_force\"\nregion = \"floor\"\n"
           "[[velocity]]\nthermal_energy = 0.05\nseed = 3\n"
           "[[probe]]\nname = \"way\"\nkind = \"displacement\"\nregion = \"floor\"\n"
           "[[probe]]\nname = \"load\"\nkind = \"force\"\nregion = \"floor\"\n"
           "[run]\ndt = 0.002\nsteps = 300\nprobe_every = 7\n";
  }

  std::string path(const std::string& name) const { return bench_.path(name); }

  Strings arguments(const Strings& more = {}) const {
    Strings list{path("block.toml"), "--frames", "0,5,50,51,300", "--energies", "--cycles"};
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }
  Strings with_checkpoint(const Strings& more = {}) const {
    Strings list = arguments({"--threads", "1", "--out", path("run.h5"), "--checkpoint", path("state"),
                              "--checkpoint-every", "2 steps"});
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }

  // Ends the program by `signal` once `ends` is true. The exit code, or -N for signal N.
  int lattice(const Strings& arguments, const Condition& ends = {}, int signal = SIGKILL) const {
    std::vector<char*> argv{const_cast<char*>(CUBOCT_LATTICE)};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      dup2(open(path("lattice.out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), 1);
      dup2(open(path("lattice.err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), 2);
      execv(CUBOCT_LATTICE, argv.data());
      _exit(127);
    }
    siginfo_t ended{};
    while (ends && waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0)
      if (ends(child)) {
        kill(child, signal);
        break;
      } else {
        usleep(200);
      }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  // The trace's bytes, but for the host's time and the counters.
  std::string bytes(const std::string& file) const {
    Trace trace = read_trace(file);
    trace.seconds = 0;
    trace.counters.clear();
    write_trace(path("plain.h5"), trace);
    return contents(path("plain.h5"));
  }

  std::string uninterrupted() const {
    EXPECT_EQ(lattice(arguments({"--threads", "2", "--out", path("whole.h5")})), 0)
        << contents(path("lattice.err"));
    return bytes(path("whole.h5"));
  }

  // Interrupts a run until it has left a checkpoint, and leaves that.
  void leave_checkpoint() const {
    // Where it ends before the signal comes, it leaves none.
    for (int tries = 0; !fs::exists(path("state")); ++tries) {
      ASSERT_LT(tries, 1000);
      fs::remove(path("state.journal"));
      lattice(with_checkpoint(), there(path("state")));
    }
  }

  void expect_refusal(const Strings& arguments, const std::string& text) const {
    EXPECT_EQ(lattice(arguments), 2);
    EXPECT_EQ(contents(path("lattice.err")), text);
  }

  void kill_and_resume(int enough);

  Bench bench_{false};
};

void Checkpoint::kill_and_resume(int enough) {
  const std::string whole = uninterrupted();
  const Trace trace = read_trace(path("whole.h5"));
  ASSERT_EQ(trace.steps(), 300u);
  ASSERT_EQ(trace.frames.size(), 5u);
  ASSERT_EQ(trace.curves.size(), 11u);
  ASSERT_FALSE(trace.cycles.empty());

  ASSERT_EQ(lattice(with_checkpoint()), 0);
  EXPECT_FALSE(fs::exists(path("state")));
  EXPECT_EQ(bytes(path("run.h5")), whole);

  std::mt19937_64 random(7);
  int lives = 0, kills = 0, resumed = 0, in_writing = 0, runs = 0;
  double longest =
      0.1;  // s of CPU time, of a life; less where runs reach their end, more where none gets far
  while (kills < enough || runs < 2) {
    fs::remove(path("run.h5"));
    for (;;) {
      ASSERT_LT(++lives, 2000);
      const bool resume = fs::exists(path("state"));
      resumed += resume;
      const Strings arguments = resume ? with_checkpoint({"--resume"}) : with_checkpoint();
      const double life = longest * (static_cast<double>(random() >> 11) * 0x1p-53);
      // Half of them as soon as a checkpoint is being written then.
      const Condition over = [&](pid_t program) {
        return cpu_seconds(program) >= life && (lives % 2 == 1 || fs::exists(path("state.tmp")));
      };
      // Kills enough: what is left runs to its end.
      const int code = lattice(arguments, kills < enough ? over : Condition());
      if (code == -SIGKILL) {
        ++kills;
        in_writing += fs::exists(path("state.tmp"));
        longest = std::min(longest * (resume ? 1.02 : 1.1), 0.3);
        // Killed behind the last step, with the trace in place and the checkpoint gone: done.
        if (fs::exists(path("state")) || !fs::exists(path("run.h5"))) continue;
      } else {
        ASSERT_EQ(code, 0) << contents(path("lattice.err"));
        longest *= 0.8;
      }
      break;
    }
    ASSERT_EQ(bytes(path("run.h5")), whole);
    fs::remove(path("state"));  // killed between the trace and the checkpoint's end
    ++runs;
  }
  printf("%d kills, %d of them within the writing of a checkpoint, %d resumed, %d runs ended\n", kills,
         in_writing, resumed, runs);
  EXPECT_GE(kills, enough);
  EXPECT_GE(resumed, enough / 2);
  EXPECT_GE(in_writing, enough / 4);
  EXPECT_GE(runs, 2);
}

TEST_F(Checkpoint, KillsLeaveNoTrace) { kill_and_resume(25); }

// Of the full tier.
TEST_F(Checkpoint, AHundredKillsLeaveNoTrace) { kill_and_resume(100); }

TEST_F(Checkpoint, CtrlCWritesOneAndSaysHowToGoOn) {
  const std::string whole = uninterrupted();
  ASSERT_EQ(lattice(with_checkpoint(), catches_interrupts, SIGINT), 1) << contents(path("lattice.err"));
  const Trace part = read_trace(path("run.h5"));
  EXPECT_LT(part.steps(), 300u);
  EXPECT_EQ(part.frames.back().step, part.steps());
  EXPECT_NE(contents(path("lattice.out"))
                .find("interrupted after step " + std::to_string(part.steps()) +
                      "; the same command with --resume goes on\n"),
            std::string::npos);
  ASSERT_EQ(lattice(with_checkpoint({"--resume"})), 0) << contents(path("lattice.err"));
  EXPECT_EQ(bytes(path("run.h5")), whole);
  EXPECT_FALSE(fs::exists(path("state")) || fs::exists(path("state.journal")));
}

TEST_F(Checkpoint, IsNotOverwrittenByARunThatForgetsIt) {
  leave_checkpoint();
  expect_refusal(with_checkpoint(), path("state") +
                                        " holds a run that did not end\n"
                                        "  hint: --resume goes on with it; to begin anew, remove it first\n");
}

TEST_F(Checkpoint, RefusesWhatIsDamaged) {
  leave_checkpoint();
  const std::string good = contents(path("state")), journal = contents(path("state.journal"));
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(path(name), std::ios::binary) << text;
  };
  const auto refused = [&](const std::string& ending) {
    const int code = lattice(with_checkpoint({"--resume"}));
    const std::string text = contents(path("lattice.err"));
    return code == 2 && text.starts_with(path("state")) && text.find(ending) != std::string::npos;
  };
  // Every 389th byte behind the version, one bit each; the plan's hash among them.
  int flips = 0;
  for (size_t at = 16; at < good.size(); at += 389, ++flips) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1 << at % 8);
    write("state", bad);
    EXPECT_TRUE(refused(" is damaged: its words hash to ")) << "byte " << at << contents(path("lattice.err"));
  }
  EXPECT_GT(flips, 12);
  for (const size_t size : {size_t{16}, size_t{100}, good.size() / 2, good.size() - 8, good.size() - 1}) {
    write("state", good.substr(0, size));
    EXPECT_TRUE(refused(" is damaged: ")) << size << contents(path("lattice.err"));
  }
  write("state", "not a checkpoint");
  EXPECT_TRUE(refused(" is not a checkpoint\n"));
  write("state", "");
  EXPECT_TRUE(refused(" is not a checkpoint\n"));
  std::string later = good;
  later[8] = 9;
  write("state", later);
  EXPECT_TRUE(refused(" is a checkpoint of version 9; this program reads version 3\n"));

  write("state", good);
  write("state.journal", journal.substr(0, 80));
  EXPECT_TRUE(refused(".journal is damaged: its checkpoint needs "));
  std::string flipped = journal;
  flipped[100] = static_cast<char>(flipped[100] ^ 4);
  write("state.journal", flipped);
  EXPECT_TRUE(refused(".journal is damaged: its words hash to "));
  write("state.journal", journal);
  EXPECT_EQ(lattice(with_checkpoint({"--resume"})), 0) << contents(path("lattice.err"));
}

// Of a stranger, who can make its hash right.
TEST_F(Checkpoint, RefusesWhatItsNumbersDoNotAllow) {
  leave_checkpoint();
  const std::string good = contents(path("state"));
  std::vector<uint64_t> words(good.size() / 8);
  std::memcpy(words.data(), good.data(), good.size());
  const auto said = [&](size_t at, uint64_t value) {
    std::vector<uint64_t> bad = words;
    bad[at] = value;
    Hash hash;
    for (size_t k = 0; k + 1 < bad.size(); ++k) hash.add(static_cast<int64_t>(bad[k]));
    bad.back() = hash.value();
    std::ofstream(path("state"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bad.data()), good.size());
    EXPECT_EQ(lattice(with_checkpoint({"--resume"})), 2) << at;
    return contents(path("lattice.err"));
  };
  // The number of probed particles; then, of the last particle of ten words, node and id, and its type above
  // its z.
  const size_t probed = 18, last = words.size() - 1 - 10;
  for (const uint64_t count : {uint64_t{1} << 40, ~uint64_t{0}})
    EXPECT_NE(said(probed, count).find(" things of 3 words do not fit behind its word 19\n"),
              std::string::npos);
  EXPECT_NE(said(last, uint64_t{1} << 63).find(": cell 2147483648 is not below "), std::string::npos);
  EXPECT_NE(said(last, words[last] | 0xffffffff).find("particle 4294967295: id 4294967295 is not below "),
            std::string::npos);
  EXPECT_NE(said(last + 3, words[last + 3] | uint64_t{77} << 56).find(": type 77 is not below 2\n"),
            std::string::npos);
}

TEST_F(Checkpoint, RefusesAnotherRun) {
  leave_checkpoint();
  // Another machine is another plan: both hashes are told.
  std::ofstream(path("arch.toml")) << "name = \"other\"\n[node]\ncapacity = 32\n";
  EXPECT_EQ(lattice(with_checkpoint({"--resume", "--arch", path("arch.toml")})), 2);
  const std::string text = contents(path("lattice.err"));
  EXPECT_TRUE(text.starts_with(path("state") + " was made by plan ")) << text;
  EXPECT_NE(text.find("; this scene and machine give plan "), std::string::npos) << text;

  const std::string hint = "\n  hint: resume with the options of the run that wrote it\n";
  const Strings plain{path("block.toml"), "--checkpoint", path("state"), "--resume", "--out", path("x.h5")};
  const auto with = [&](const Strings& more) {
    Strings list = plain;
    list.insert(list.end(), more.begin(), more.end());
    return list;
  };
  expect_refusal(with({"--cycles", "--energies", "--frames", "0,5,50,51,300", "--hash-every", "3"}),
                 path("state") + " was made with a hash every 1 steps, this run has one every 3" + hint);
  expect_refusal(with({"--energies", "--frames", "0,5,50,51,300"}),
                 path("state") + " was made with cycles" + hint);
  expect_refusal(
      with({"--cycles", "--frames", "0,5,50,51,300"}),
      path("state") + " was made with other probes\n  hint: resume with the scene that wrote it\n");
  expect_refusal(with({"--cycles", "--energies", "--frames", "0,1,300"}),
                 path("state") + " was made with frames at other steps" + hint);
  uint64_t step = 0;  // the fourth word of the file
  std::memcpy(&step, contents(path("state")).data() + 24, sizeof step);
  expect_refusal(with({"--cycles", "--energies", "--steps", "1"}),
                 path("state") + " was made with more steps: it is at step " + std::to_string(step) +
                     " of this run's 1" + hint);
}

TEST_F(Checkpoint, RefusesWhatCannotBe) {
  expect_refusal(with_checkpoint({"--resume"}), "there is no checkpoint " + path("state") +
                                                    "\n  hint: leave out --resume to begin at step 0\n");
  expect_refusal({path("block.toml"), "--out", path("x.h5"), "--resume"},
                 "--resume and --checkpoint-every need --checkpoint FILE\n");
  for (const char* interval : {"5", "x steps", "1.5 steps", "-3 s", "5 days"})
    expect_refusal(
        arguments({"--out", path("x.h5"), "--checkpoint", path("state"), "--checkpoint-every", interval}),
        fmt::format("'{}' says no interval between checkpoints\n"
                    "  hint: such as '1000 steps', '30 s', '5 min' or '2 h'\n",
                    interval));
}

TEST_F(Checkpoint, ServesTheStateBeforeAFault) {
  // The first particle flies out of the lattice in step 350: golden's last state, from a checkpoint and from
  // the start.
  std::ofstream(path("stray.toml"))
      << "title = \"Stray\"\nunits = \"reduced\"\nmass = 1.0\n"
         "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
         "[[particle]]\nposition = [0.0, 0.0, 0.0]\nvelocity = [0.0, -9.0, 0.0]\n"
         "[[particle]]\nposition = [1.12, 0.0, 0.0]\n"
         "[run]\ndt = 0.001\nsteps = 2000\n";
  ASSERT_EQ(bench_.cuboct({"run", path("stray.toml"), "--engine", "golden", "--out", path("golden")}).code,
            1);
  const Trace golden = read_trace(path("golden/trace.h5"));
  for (const Strings& more :
       {Strings{}, Strings{"--checkpoint", path("state"), "--checkpoint-every", "40 steps"}}) {
    Strings list{path("stray.toml"), "--out", path("stray.h5")};
    list.insert(list.end(), more.begin(), more.end());
    EXPECT_EQ(lattice(list), 1);
    EXPECT_EQ(
        contents(path("lattice.err")),
        path("stray.toml") + ": step 350, cell 1 at (0, -1, 0), particle 0: left the lattice along y (0)\n");
    const Trace trace = read_trace(path("stray.h5"));
    EXPECT_EQ(trace.stop, golden.stop);
    EXPECT_EQ(trace.state_hash, golden.state_hash);
    EXPECT_EQ(trace.frames, golden.frames);
    EXPECT_EQ(trace.frames.back().step, 350u);
    EXPECT_FALSE(fs::exists(path("state")));
  }
}

}  // namespace
}  // namespace cuboct::test
