// SPDX-License-Identifier: MIT
// Commands that are programs beside cuboct: it becomes them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

class Programs : public testing::Test {
 protected:
  // In place of cuboct-study.
  void put(const std::string& script) {
    const std::string path = bench_.path("bin/cuboct-study");
    fs::remove(path);
    std::ofstream(path) << "#!/bin/sh\n" << script;
    fs::permissions(path, fs::perms::owner_all);
  }
  // By a shell, in the bench's own directory; its exit code is in the answer.
  Answer shell(const std::string& command) {
    const std::string all = "cd '" + bench_.path("") + "' && { " + command + "; } >out 2>err";
    const int status = std::system(all.c_str());
    return {WEXITSTATUS(status), contents(bench_.path("out")), contents(bench_.path("err"))};
  }

  Bench bench_{false};
};

TEST_F(Programs, HaveTheWordsStreamsAndExitCodeOfTheCommand) {
  put("printf '%s|' \"$@\"; cat; echo told >&2; exit 7\n");
  const Answer answer = shell("echo asked | bin/cuboct explore 'a  b' --json '' --key= -x");
  EXPECT_EQ(answer.code, 7);
  EXPECT_EQ(answer.out, "explore|a  b|--json||--key=|-x|asked\n");
  EXPECT_EQ(answer.err, "told\n");
  EXPECT_EQ(shell("bin/cuboct help fit </dev/null").out, "fit|--help|");
}

TEST_F(Programs, AreTheSameProcess) {
  put("echo $$\n");
  const Answer answer = shell("sh -c 'echo $$; exec bin/cuboct pitch'");
  const size_t half = answer.out.size() / 2;
  ASSERT_GT(half, 1u);
  EXPECT_EQ(answer.out.substr(0, half), answer.out.substr(half));
}

TEST_F(Programs, MeetCtrlC) {
  put("trap 'exit 5' INT\n: >" + bench_.path("begun") + "\nwhile :; do sleep 0.01; done\n");
  EXPECT_EQ(bench_.cuboct({"multiscale"}, there(bench_.path("begun"))).code, 5);
}

TEST_F(Programs, AreToldWhereTheyAreMissing) {
  fs::remove(bench_.path("bin/cuboct-study"));
  const Answer answer = bench_.cuboct({"elastic", "scenes/lj_block.toml"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.out, "");
  EXPECT_EQ(answer.err,
            "elastic: no program cuboct-study beside cuboct\n  hint: build the target cuboct-study\n");
  const Answer json = bench_.cuboct({"elastic", "--json"});
  EXPECT_EQ(json.code, 2);
  EXPECT_EQ(nlohmann::json::parse(json.err)["error"]["message"],
            "elastic: no program cuboct-study beside cuboct");
  EXPECT_NE(bench_.cuboct({"--help"}).out.find("\n  elastic     elastic constants"), std::string::npos);
  put("echo no program\n");
  fs::permissions(bench_.path("bin/cuboct-study"), fs::perms::owner_read);
  EXPECT_EQ(bench_.cuboct({"elastic"}).err, answer.err);
}

TEST_F(Programs, KnowAllCommands) {
  for (const char* program : {"cuboct-study", "cuboct-machine", "cuboct-bench"}) {
    const std::string name = std::string("bin/") + program;
    EXPECT_EQ(shell(name + " --help").out, bench_.cuboct({"--help"}).out) << program;
    EXPECT_EQ(shell(name + " run --help").out, bench_.cuboct({"run", "--help"}).out) << program;
    const Answer none = shell(name + " rnu");
    EXPECT_EQ(none.code, 2) << program;
    EXPECT_EQ(none.err, "unknown command 'rnu'\n  hint: did you mean 'run'?\n") << program;
  }
}

}  // namespace
}  // namespace cuboct::test
