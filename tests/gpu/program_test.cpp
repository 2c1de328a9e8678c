// SPDX-License-Identifier: MIT
// The gpu engine as users meet it: `cuboct` with cuboct-gpu beside it, here the one that computes on the
// host.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "emu/gpu/run.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"
#include "tests/support/file_limit.h"

namespace cuboct {
namespace {

using test::Answer;
using test::contents;

const std::string kBlock = "scenes/lj_block.toml";

class GpuProgram : public testing::Test {
 protected:
  GpuProgram() { std::filesystem::copy(CUBOCT_GPU_HOST, bench_.path("bin/cuboct-gpu")); }

  // Runs cuboct-gpu itself, in the root of the sources.
  Answer program(const std::string& arguments) const {
    const std::string out = bench_.path("gpu.out"), err = bench_.path("gpu.err");
    const std::string command = "cd " CUBOCT_SOURCE_DIR " && " + bench_.path("bin/cuboct-gpu") + " " +
                                arguments + " >" + out + " 2>" + err + " </dev/null";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), contents(out), contents(err)};
  }
  Trace run(const std::string& name, std::vector<std::string> arguments, int code = 0) const {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--out", bench_.path(name)});
    answer_ = bench_.cuboct(arguments);
    EXPECT_EQ(answer_.code, code) << answer_.out << answer_.err;
    return read_trace(bench_.path(name) + "/trace.h5");
  }
  void expect_refusal(const std::vector<std::string>& arguments, const std::string& text) const {
    const Answer answer = bench_.cuboct(arguments);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.err, text);
    EXPECT_EQ(answer.out, "");
  }

  test::Bench bench_{false};
  mutable Answer answer_;
};

std::string lines_with(const std::string& text, const std::string& word) {
  std::istringstream in(text);
  std::string found;
  for (std::string line; std::getline(in, line);)
    if (line.find(word) != std::string::npos) found += line + "\n";
  return found;
}

// The same names, units and steps, and values to `tolerance` of the largest of the curve.
void expect_curves(const Trace& a, const Trace& b, double tolerance) {
  ASSERT_EQ(a.curves.size(), b.curves.size());
  ASSERT_FALSE(a.curves.empty());
  for (size_t k = 0; k < a.curves.size(); ++k) {
    const Curve &one = a.curves[k], &other = b.curves[k];
    EXPECT_EQ(one.name, other.name);
    EXPECT_EQ(one.unit, other.unit);
    EXPECT_EQ(one.step, other.step);
    double most = 0;
    for (const double value : other.value) most = std::max(most, std::abs(value));
    ASSERT_EQ(one.value.size(), other.value.size());
    for (size_t i = 0; i < one.value.size(); ++i)
      EXPECT_NEAR(one.value[i], other.value[i], tolerance * most) << one.name << " at step " << one.step[i];
  }
}

TEST_F(GpuProgram, HasGoldensBits) {
  Answer answer = bench_.cuboct({"crosscheck", kBlock, "--steps", "5", "--engines", "golden,lattice,gpu"});
  EXPECT_EQ(answer.out, "matched 1280 updates over 5 steps in 3 engines\n");
  EXPECT_EQ(answer.err, "");
  EXPECT_EQ(answer.code, 0);
  answer = bench_.cuboct(
      {"crosscheck", "scenes/coupon.toml", "--steps", "5", "--engines", "lattice,gpu", "--gpus", "2"});
  EXPECT_EQ(answer.out, "matched 13455 updates over 5 steps in 2 engines\n") << answer.err;
}

TEST_F(GpuProgram, LeavesTheSameFilesAsGolden) {
  const std::vector<std::string> scene{"scenes/coupon.toml", "--steps", "60", "--frame-every", "30"};
  std::vector<std::string> golden = scene, gpu = scene;
  golden.insert(golden.end(), {"--engine", "golden"});
  gpu.insert(gpu.end(), {"--engine", "gpu", "--hash-every", "25"});
  const Trace a = run("gpu", gpu);
  const std::string told = answer_.out;
  const Trace b = run("golden", golden);
  expect_curves(a, b, 1e-11);
  EXPECT_EQ(a.curves.front().name, b.curves.front().name);
  ASSERT_EQ(a.frames.size(), 3u);
  for (size_t k = 0; k < 3; ++k) EXPECT_EQ(a.frames[k], b.frames[k]);
  ASSERT_EQ(a.state_hash.size(), 4u);
  for (size_t k = 0; k < 4; ++k) EXPECT_EQ(a.state_hash[k], b.state_hash[std::min<size_t>(25 * k, 60)]);
  EXPECT_TRUE(a.bodies.empty());
  for (const char* file : {"/frames.xyz", "/frames_000001.vtp", "/plan.txt"}) {
    EXPECT_NE(contents(bench_.path("gpu") + file), "") << file;
    EXPECT_EQ(contents(bench_.path("gpu") + file), contents(bench_.path("golden") + file)) << file;
  }
  for (const char* line : {"momentum change", "energy change", "energy   ", "state hash", "plan hash"}) {
    EXPECT_NE(lines_with(told, line), "") << line;
    EXPECT_EQ(lines_with(told, line), lines_with(answer_.out, line));
  }
}

// The virial of the integers' own kicks, with damping too.
TEST_F(GpuProgram, MeasuresPressureAsGoldenDoes) {
  const std::string damped = bench_.path("damped.toml");
  std::ofstream(damped) << contents(CUBOCT_SOURCE_DIR "/" + kBlock) << "\n[damping]\nratio = 0.1\n";
  for (const std::string& scene : {kBlock, damped}) {
    const Trace gpu = run("gpu", {scene, "--steps", "10", "--engine", "gpu"});
    const Trace golden = run("golden", {scene, "--steps", "10", "--engine", "golden"});
    ASSERT_EQ(gpu.curves.back().name, "pressure");
    EXPECT_NE(golden.curves.back().value.back(), 0);
    expect_curves(gpu, golden, 1e-11);
  }
}

// Its frames come one by one, and what fields and bonds keep comes behind them.
TEST_F(GpuProgram, LeavesARuleThatRemembersToGoOn) {
  const std::string heat = "scenes/rules/heat.toml";
  run("half", {heat, "--steps", "3", "--engine", "gpu", "--rule-code", "interpreted"});
  const Trace rest = run("rest", {heat, "--steps", "2", "--engine", "golden", "--from", bench_.path("half")});
  const Trace whole = run("whole", {heat, "--steps", "5", "--engine", "golden"});
  EXPECT_EQ(rest.state_hash.back(), whole.state_hash.back());
}

TEST_F(GpuProgram, TellsAFaultAsGoldenDoes) {
  const Trace gpu = run("gpu", {"scenes/failures/velocity.toml", "--engine", "gpu", "--quiet"}, 1);
  const Answer told = answer_;
  const Trace golden = run("golden", {"scenes/failures/velocity.toml", "--engine", "golden", "--quiet"}, 1);
  ASSERT_TRUE(gpu.stop && golden.stop);
  EXPECT_EQ(*gpu.stop, *golden.stop);
  EXPECT_EQ(gpu.steps(), golden.steps());
  EXPECT_EQ(gpu.state_hash.back(), golden.state_hash.back());
  for (const char* line : {"stopped", "advice", "last look", "momentum change"})
    EXPECT_EQ(lines_with(told.out, line), lines_with(answer_.out, line));
  EXPECT_EQ(told.err, answer_.err);
}

TEST_F(GpuProgram, WatchesAsGoldenDoes) {
  const std::string scene = "scenes/failures/constraint_work.toml";
  const Trace gpu = run("gpu", {scene, "--engine", "gpu"}, 1);
  const std::string told = lines_with(answer_.out, "warning: ");
  EXPECT_NE(told, "");
  run("golden", {scene, "--engine", "golden"}, 1);
  EXPECT_EQ(told, lines_with(answer_.out, "warning: "));
  EXPECT_EQ(gpu.findings.size(), 1u);
  EXPECT_EQ(gpu.watched, gpu.steps());
  const Trace silent = run("silent", {scene, "--engine", "gpu", "--no-watch"});
  EXPECT_FALSE(silent.watched);
  EXPECT_EQ(lines_with(answer_.out, "warning"), "");
}

TEST_F(GpuProgram, MeasuresRealNumbersAsTheReferenceDoes) {
  for (const std::string precision : {"double", "float"}) {
    const auto of = [&](const char* engine) {
      return run(engine, {kBlock, "--steps", "20", "--frame-every", "10", "--precision", precision,
                          "--engine", engine});
    };
    const Trace gpu = of("gpu");
    const std::string told = answer_.out;
    expect_curves(gpu, of("reference"), precision == "float" ? 1e-5 : 1e-12);
    EXPECT_EQ(gpu.curves.back().name, "pressure");
    ASSERT_EQ(gpu.bodies.size(), 3u);
    EXPECT_EQ(gpu.bodies[1].step, 10u);
    EXPECT_EQ(gpu.bodies[1].x.size(), 256u);
    EXPECT_TRUE(gpu.bodies[1].force.empty());
    EXPECT_TRUE(gpu.state_hash.empty());
    EXPECT_EQ(gpu.steps(), 20u);
    EXPECT_NE(lines_with(told, "precision        " + precision), "");
    EXPECT_NE(contents(bench_.path("gpu") + "/frames.xyz"), "");
  }
}

// Ctrl-C of the command, which starts the program: until the run is over.
TEST_F(GpuProgram, GoesOnWhereCtrlCLeftIt) {
  for (const std::string precision : {"fixed", "float"}) {
    const std::string out = bench_.path("parts" + precision);
    const auto arguments = [&](uint64_t steps) {
      return std::vector<std::string>{
          "scenes/coupon.toml",  "--engine",      "gpu", "--precision", precision, "--quiet", "--steps",
          std::to_string(steps), "--frame-every", "200", "--anyway"};
    };
    const auto part = [&](uint64_t steps, bool resumes, const test::Condition& interrupts) {
      std::vector<std::string> words = arguments(steps);
      words.insert(words.begin(), "run");
      words.insert(words.end(), {"--out", out, "--checkpoint-every", "1 h"});
      if (resumes) words.emplace_back("--resume");
      return bench_.cuboct(words, interrupts);
    };
    // Each goes on until it has left another frame than those before; none would ever end.
    uint64_t steps = 0;
    for (const bool resumes : {false, true}) {
      const Answer cut =
          part(10'000'000, resumes, test::there(fmt::format("{}/frames_{:06}.vtp", out, steps / 200 + 2)));
      ASSERT_EQ(cut.code, 1) << cut.err;
      steps = read_trace(out + "/trace.h5").steps();
      EXPECT_EQ(cut.err,
                fmt::format("interrupted; the same command with --resume goes on at step {}\n", steps));
    }
    steps += 250;
    const Answer answer = part(steps, true, {});
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Trace parts = read_trace(out + "/trace.h5"), whole = run("whole" + precision, arguments(steps));
    EXPECT_EQ(whole.state_hash, parts.state_hash);
    EXPECT_EQ(whole.frames, parts.frames);
    ASSERT_EQ(whole.bodies.size(), parts.bodies.size());
    for (size_t k = 0; k < whole.bodies.size(); ++k) EXPECT_EQ(whole.bodies[k].x, parts.bodies[k].x);
    expect_curves(whole, parts, precision == "fixed" ? 1e-12 : 0);
    EXPECT_FALSE(std::filesystem::exists(out + "/checkpoint"));
  }
}

// A cuboct-gpu that reads another scene than it was given.
void make_wrong(const test::Bench& bench, const std::string& edit) {
  namespace fs = std::filesystem;
  const std::string program = bench.path("bin/cuboct-gpu");
  fs::rename(program, program + "-sound");
  std::ofstream(program) << "#!/bin/sh\nsed '" << edit << "' \"$1\" >" << bench.path("wrong.toml")
                         << "\nshift\nexec " << program << "-sound " << bench.path("wrong.toml")
                         << " \"$@\"\n";
  fs::permissions(program, fs::perms::owner_all);
}

TEST_F(GpuProgram, OfRealNumbersIsWithinBoundsOfTheReference) {
  for (const char* scene : {"scenes/lj_block.toml", "scenes/coupon.toml", "scenes/hot_cluster.toml"})
    for (const std::string precision : {"float", "double"}) {
      const Answer answer = bench_.cuboct(
          {"crosscheck", scene, "--engines", "reference,gpu", "--precision", precision, "--steps", "30"});
      EXPECT_EQ(answer.code, 0) << scene << "\n" << answer.out << answer.err;
      EXPECT_NE(lines_with(answer.out, "forces at the start: largest error "), "");
      EXPECT_NE(lines_with(answer.out, "forces after 30 steps: largest error "), "");
      EXPECT_NE(lines_with(answer.out, "(of the reference in floats "), "");
      EXPECT_NE(
          lines_with(answer.out, " particles over 30 steps, gpu in " + precision + "s against the reference"),
          "");
    }
}

TEST_F(GpuProgram, OfALawAThousandthOffIsBeyondItsBounds) {
  make_wrong(bench_, "s/epsilon = 1.0/epsilon = 1.001/");
  const Answer answer = bench_.cuboct({"crosscheck", kBlock, "--engines", "gpu,reference"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(lines_with(answer.out, "beyond its bound: particle "), "") << answer.out << answer.err;
  EXPECT_EQ(lines_with(answer.out, "within bounds"), "");
  // Bits: the plan is another.
  const Answer fixed = bench_.cuboct({"crosscheck", kBlock, "--engines", "golden,gpu", "--steps", "2"});
  EXPECT_EQ(fixed.code, 1);
  EXPECT_NE(lines_with(fixed.out, "mismatch: plan hash: cuboct "), "");
}

TEST_F(GpuProgram, OfALongerStepIsBeyondTheBoundOfPositions) {
  make_wrong(bench_, "s/dt = 0.004/dt = 0.0041/");
  const Answer answer = bench_.cuboct({"crosscheck", kBlock, "--engines", "reference,gpu", "--steps", "30"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find("nearest to its bound"), std::string::npos) << answer.out << answer.err;
  EXPECT_EQ(lines_with(answer.out, "beyond its bound").find("particle"), 18u);
  EXPECT_LT(answer.out.find("positions after"), answer.out.find("beyond its bound"));
}

TEST_F(GpuProgram, EndsEarlyWhenItIsAsked) {
  const Answer answer =
      bench_.cuboct({"run", kBlock, "--engine", "gpu", "--steps", "100000000", "--quiet", "--out",
                     bench_.path("run"), "--hash-every", "1000000", "--frame-every", "1000", "--anyway"},
                    test::there(bench_.path("run/frames_000001.vtp")));
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "interrupted\n");
  const Trace trace = read_trace(bench_.path("run") + "/trace.h5");
  EXPECT_GT(trace.steps(), 0u);
  EXPECT_EQ(trace.frames.back().step, trace.steps());
  EXPECT_EQ(trace.curves.back().step.back(), trace.steps());
  EXPECT_FALSE(trace.stop);
}

// One line, and the directory as it was: what the engine hands over did not fit.
TEST_F(GpuProgram, AFullDiskFailsCleanly) {
  run("kept", {kBlock, "--engine", "gpu", "--steps", "3"});
  const std::string before = contents(bench_.path("kept/summary.json"));
  for (const std::string precision : {"fixed", "float"}) {
    const FileLimit limit(100 << 10);
    const Answer answer =
        bench_.cuboct({"run", kBlock, "--engine", "gpu", "--precision", precision, "--steps", "80",
                       "--frame-every", "1", "--quiet", "--out", bench_.path("kept")});
    EXPECT_EQ(answer.code, 2);
    EXPECT_TRUE(answer.err.starts_with("cannot write ") && answer.err.ends_with("/gpu.h5: File too large\n"))
        << answer.err;
    EXPECT_EQ(answer.out, "");
  }
  EXPECT_EQ(contents(bench_.path("kept/summary.json")), before);
  run("kept", {kBlock, "--engine", "gpu", "--steps", "4"});
}

TEST_F(GpuProgram, RefusesWhatItCannotDo) {
  std::vector<std::string> gpu{"run", kBlock, "--engine", "gpu", "--steps", "1"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = gpu;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_refusal(with({"--integrator", "verlet"}),
                 "--integrator is an option of the reference engine, not of gpu\n");
  expect_refusal(
      with({"--threads", "2"}),
      "--threads is an option of the lattice, the systemc, the rtl and the reference engine, not of gpu\n");
  expect_refusal(with({"--cycles"}), "--cycles is an option of the lattice engine, not of gpu\n");
  expect_refusal(
      with({"--gpus", "9"}),
      "--gpus 9: this machine has 8 CUDA devices\n  hint: --devices 0,0 puts two parts of a scene on one\n");
  expect_refusal(with({"--devices", "0,17"}),
                 "--devices: there is no CUDA device 17\n  hint: one of 0, 1, 2, 3, 4, 5, 6, 7\n");
  expect_refusal(with({"--precision", "float", "--hash-every", "5"}),
                 "--hash-every goes with --precision fixed\n  hint: states in real numbers have no hash\n");
  expect_refusal({"run", kBlock, "--engine", "reference", "--precision", "fixed"},
                 "--precision fixed: the reference engine computes in doubles or floats\n"
                 "  hint: lattice, golden and gpu compute in the fixed rule's integers\n");
  expect_refusal({"crosscheck", kBlock, "--engines", "golden,gpu", "--precision", "float"},
                 "--precision goes with --engines reference,gpu\n"
                 "  hint: other engines compute in the fixed rule\n");
  expect_refusal({"run", kBlock, "--joules"}, "--joules is an option of the gpu engine, not of lattice\n");
  expect_refusal({"run", kBlock, "--gpus", "2"}, "--gpus is an option of the gpu engine, not of lattice\n");
  expect_refusal({"run", kBlock, "--engine", "golden", "--devices", "0"},
                 "--devices is an option of the gpu engine, not of golden\n");
}

// A table that no block of threads holds.
TEST_F(GpuProgram, RefusesAtTheKeyOfTheArch) {
  const std::string arch = bench_.path("wide.toml");
  std::ofstream(arch) << "name = \"wide\"\n[table]\nindex_bits = 16\n";
  const Answer answer = bench_.cuboct({"run", kBlock, "--engine", "gpu", "--arch", arch, "--steps", "1"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with(arch + ":3:14: the rule's tables take ")) << answer.err;
  EXPECT_NE(answer.err.find("\n   3 | index_bits = 16\n     |              ^\n  hint: fewer of the arch's "
                            "table.index_bits\n"),
            std::string::npos)
      << answer.err;
}

TEST_F(GpuProgram, SaysWhatIsMissing) {
  std::filesystem::remove(bench_.path("bin/cuboct-gpu"));
  const std::string text =
      "the gpu engine is not built: no program cuboct-gpu beside cuboct\n"
      "  hint: install the CUDA toolkit (nvcc), configure and build again\n";
  expect_refusal({"run", kBlock, "--engine", "gpu"}, text);
  expect_refusal({"crosscheck", kBlock, "--engines", "golden,gpu"}, text);
}

TEST_F(GpuProgram, SaysWhereNoEnergyCouldBeMeasured) {
  for (const std::string scene : {kBlock.c_str(), "scenes/rules/heat.toml"}) {
    const Trace trace = run("joules", {scene, "--steps", "2", "--engine", "gpu", "--joules", "--force"});
    EXPECT_NE(lines_with(answer_.out, "not measured: "), "") << scene;
    for (const auto& [name, value] : trace.counters)
      EXPECT_EQ(name.find("joules"), std::string::npos) << value;
  }
}

TEST_F(GpuProgram, StandsAlone) {
  const std::string out = bench_.path("alone.h5"), to = kBlock + " --steps 4 --out " + out;
  EXPECT_EQ(program(to).code, 0);
  const Trace trace = read_trace(out);
  ASSERT_EQ(trace.frames.size(), 2u);
  EXPECT_EQ(trace.frames[1].step, 4u);
  EXPECT_EQ(trace.state_hash.size(), 5u);
  EXPECT_TRUE(trace.curves.empty());  // the scene has no probes
  EXPECT_EQ(program(to + " --frames 3 --precision double --forces").code, 0);
  const Trace real = read_trace(out);
  ASSERT_EQ(real.bodies.size(), 2u);
  EXPECT_EQ(real.bodies[0].step, 3u);
  // The force of a step is what it adds to the velocity; nothing else acts here. Mass and dt: kBlock's.
  for (size_t i = 0; i < 256; ++i) {
    const Vec3 gained = (real.bodies[1].v[i] - real.bodies[0].v[i]) / 0.004;
    EXPECT_LT((gained - real.bodies[0].force[i]).norm(), 1e-9 * (1 + gained.norm()));
  }
  const Answer bench = program(kBlock + " --steps 4 --bench");
  EXPECT_EQ(bench.code, 0);
  EXPECT_NE(lines_with(bench.out, "gpu.particle_steps "), "");
  EXPECT_NE(lines_with(bench.out, "gpu.list_builds "), "");
  for (const auto& [arguments, text] :
       {std::pair<std::string, std::string>{kBlock, "--out is required\n"},
        {to + " --block 100", "--block 100: not a multiple of 32 from 32 to 256\n"},
        {to + " --forces",
         "--forces goes with --precision float or double\n  hint: fixed states determine their forces\n"}}) {
    const Answer refused = program(arguments);
    EXPECT_EQ(refused.code, 2);
    EXPECT_EQ(refused.err, text);
  }
}

TEST(GpuLooks, AreAllOrAFew) {
  std::vector<uint64_t> probes;
  for (uint64_t k = 0; k <= 1000; ++k) probes.push_back(10 * k);
  EXPECT_EQ(gpu::watch_steps(probes, 1000), probes);
  const auto few = gpu::watch_steps(probes, 10'000'000);  // 1001 looks would be 1e10 particles
  EXPECT_EQ(few.size(), 5u);
  EXPECT_EQ(few.front(), 0u);
  EXPECT_EQ(few[1], 2010u);
  EXPECT_TRUE(gpu::watch_steps({}, 1000).empty());
  EXPECT_EQ(gpu::watch_steps({0, 7}, 1'000'000'000), (std::vector<uint64_t>{0, 7}));
}

// A law that integers refuse: an exponential of what no distance bounds from below.
const char* const kMorse = R"toml(units = "reduced"
mass = 1.0

[rule]
name = "morse"
reach = "1.7"
parameters = { depth = 1.0, width = 5.0, friction = 0.1 }
let.e = "exp(-width * (r - 1))"
particle.heat.what = "what friction took"
round = [{ sum.pull = "2 * depth * width * (e - e^2) * d / r", finish.force = "pull - friction * mass * v / sqrt(1 + norm(v))", finish.heat = "heat + dt * friction * dot(v, v)" }]
energy.pair = "depth * (e^2 - 2 * e)"

[packing]
pitch = 1.0

[box]
cells = [4, 4, 4]
periodic = "xyz"

[[velocity]]
thermal_energy = 0.2
seed = 1

[[probe]]
name = "all"
kind = "temperature"
region = { shape = "sphere", radius = 100 }

[run]
dt = 0.004
steps = 40
frame_every = 20
)toml";

TEST_F(GpuProgram, RunsARuleOfTextInRealNumbers) {
  const std::string scene = bench_.path("morse.toml");
  std::ofstream(scene) << kMorse;
  for (const std::string precision : {"double", "float"}) {
    const Trace gpu = run("gpu" + precision, {scene, "--engine", "gpu", "--precision", precision});
    EXPECT_NE(lines_with(answer_.out, "compiled for host"), "");
    const Trace reference = run("reference" + precision, {scene, "--engine", "reference"});
    const double tolerance = precision == "float" ? 1e-5 : 1e-12;
    expect_curves(gpu, reference, tolerance);
    ASSERT_EQ(gpu.bodies.size(), 3u);
    ASSERT_EQ(gpu.bodies[2].shown.size(), 1u);
    EXPECT_EQ(gpu.bodies[2].step, 40u);
    for (size_t i = 0; i < 256; ++i) {
      EXPECT_GT(reference.bodies[2].shown[0][i], 0);
      EXPECT_NEAR(gpu.bodies[2].shown[0][i], reference.bodies[2].shown[0][i], 10 * tolerance);
    }
  }
  EXPECT_EQ(bench_.cuboct({"report", bench_.path("gpufloat")}).code, 0);
  const Trace one = run("one", {scene, "--engine", "gpu", "--precision", "float"}),
              three = run("three", {scene, "--engine", "gpu", "--precision", "float", "--gpus", "3"});
  EXPECT_EQ(three.bodies[2].x, one.bodies[2].x);
  EXPECT_EQ(three.bodies[2].v, one.bodies[2].v);
  EXPECT_EQ(three.bodies[2].shown, one.bodies[2].shown);
}

// As `cuboct` in Python steps it: each run ends where it is told to, and the next one goes on from there.
TEST_F(GpuProgram, PausesAndGoesOn) {
  const std::string scene = bench_.path("morse.toml"), kept = bench_.path("kept"), out = bench_.path("a.h5");
  std::ofstream(scene) << kMorse;
  const std::string words = fmt::format(
      "{} --precision float --out {} --hash-every 0 --frames 0 --steps 40 --checkpoint {}", scene, out, kept);
  const Answer first = program(words + " --pause-after 7");
  EXPECT_EQ(first.code, 1) << first.err;
  EXPECT_NE(first.out.find("interrupted after step 7; the same command with --resume goes on"),
            std::string::npos)
      << first.out;
  EXPECT_EQ(program(words + " --pause-after 11 --resume").code, 1);
  const Trace whole = run("whole", {scene, "--engine", "gpu", "--precision", "float", "--steps", "18"}),
              parts = read_trace(out);
  EXPECT_EQ(parts.bodies.back().step, 18u);
  EXPECT_EQ(parts.bodies.back().x, whole.bodies.back().x);
  EXPECT_EQ(parts.bodies.back().v, whole.bodies.back().v);
  std::string doubles = words;
  const Answer other = program(doubles.replace(doubles.find("float"), 5, "double") + " --resume");
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("was made with another engine or --precision"), std::string::npos) << other.err;
  EXPECT_EQ(program(words + " --pause-after 30 --resume").code, 0);
  EXPECT_FALSE(std::filesystem::exists(kept));
  const Answer refused = program(fmt::format("{} --out {} --pause-after 3", scene, out));
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.err, "--pause-after goes with --checkpoint FILE\n");
}

TEST_F(GpuProgram, OfARuleOfTextHasGoldensBitsOnSeveralDevices) {
  Answer answer = bench_.cuboct(
      {"crosscheck", "scenes/rules/heat.toml", "--steps", "20", "--engines", "golden,gpu", "--gpus", "3"});
  EXPECT_EQ(answer.out, "matched 25600 updates over 20 steps in 2 engines\n") << answer.err;
  // The watch and the probes read the whole.
  const auto glass = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"scenes/rules/glass.toml", "--steps", "20", "--quiet", "--anyway"});
    return run(name, more);
  };
  const Trace two = glass("two", {"--engine", "gpu", "--devices", "0,0"});
  const Trace golden = glass("golden", {"--engine", "golden"});
  EXPECT_EQ(two.state_hash.back(), golden.state_hash.back());
  EXPECT_EQ(two.frames, golden.frames);
  EXPECT_EQ(two.watched, golden.watched);
  expect_curves(two, golden, 1e-11);
  expect_refusal({"run", "scenes/rules/dpd.toml", "--engine", "gpu", "--gpus", "8"},
                 "8 slabs of a plane of cells or more: the scene has 5 along its longest axis\n"
                 "  hint: use fewer devices\n");
}

// What a run on two devices left goes on on one, and then on three.
TEST_F(GpuProgram, OfARuleOfTextGoesOnOnOtherDevices) {
  const std::string out = bench_.path("parts");
  const auto arguments = [](uint64_t steps) {
    return std::vector<std::string>{"scenes/rules/dpd.toml", "--engine",      "gpu", "--quiet", "--steps",
                                    std::to_string(steps),   "--frame-every", "30",  "--anyway"};
  };
  const auto part = [&](uint64_t steps, const char* gpus, const test::Condition& interrupts) {
    std::vector<std::string> words = arguments(steps);
    words.insert(words.begin(), "run");
    words.insert(words.end(), {"--gpus", gpus, "--out", out, "--checkpoint-every", "1 h"});
    if (std::filesystem::exists(out)) words.emplace_back("--resume");
    return bench_.cuboct(words, interrupts);
  };
  uint64_t steps = 0;
  for (const char* gpus : {"2", "1"}) {
    const Answer cut =
        part(10'000'000, gpus, test::there(fmt::format("{}/frames_{:06}.vtp", out, steps / 30 + 2)));
    ASSERT_EQ(cut.code, 1) << cut.err;
    steps = read_trace(out + "/trace.h5").steps();
  }
  steps += 40;
  const Answer answer = part(steps, "3", {});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Trace parts = read_trace(out + "/trace.h5"), whole = run("whole", arguments(steps));
  EXPECT_EQ(whole.state_hash, parts.state_hash);
  EXPECT_EQ(whole.frames, parts.frames);
}

TEST_F(GpuProgram, OfARuleOfTextIsWithinBoundsOfTheReference) {
  const std::string scene = bench_.path("morse.toml");
  std::ofstream(scene) << kMorse;
  const auto crosscheck = [&](const std::string& of, const std::string& precision) {
    return bench_.cuboct(
        {"crosscheck", of, "--engines", "reference,gpu", "--precision", precision, "--steps", "30"});
  };
  for (const std::string precision : {"float", "double"}) {
    for (const std::string& of : {scene, std::string("scenes/rules/heat.toml")}) {
      const Answer answer = crosscheck(of, precision);
      EXPECT_EQ(answer.code, 0) << answer.out << answer.err;
      EXPECT_NE(lines_with(answer.out, "at the start: largest error "), "");
      EXPECT_NE(lines_with(answer.out, " after 30 steps: largest error "), "");
      EXPECT_NE(
          lines_with(answer.out, " particles over 30 steps, gpu in " + precision + "s against the reference"),
          "");
    }
  }
  make_wrong(bench_, "s/depth = 1.0/depth = 1.001/");
  const Answer answer = crosscheck(scene, "float");
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(lines_with(answer.out, "beyond its bound: particle "), "") << answer.out << answer.err;
}

TEST_F(GpuProgram, SaysHowARuleOfTextRuns) {
  const auto says = [&](const std::string& options) {
    const std::string out = bench_.path("text.trace");
    const Answer answer = program("scenes/rules/heat.toml --steps 3 --out " + out + options);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return lines_with(answer.out, "kernels");
  };
  EXPECT_EQ(says(" --precision double"), "the rule's kernels are compiled for host\n");
  const Answer refused =
      program("scenes/rules/heat.toml --precision double --rule-code interpreted --out out");
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.err,
            "--rule-code interpreted goes with --precision fixed\n"
            "  hint: a rule of text in real numbers is compiled for the device\n");
  EXPECT_EQ(says(" --rule-code interpreted"), "the rule's kernels are interpreted\n");
  EXPECT_EQ(says(""), "the rule's kernels are interpreted: CUDA's compiler knows no architecture 'host'\n");
}

}  // namespace
}  // namespace cuboct
