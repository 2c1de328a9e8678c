// SPDX-License-Identifier: MIT
#include "cli/programs.h"

#include <fmt/format.h>

#include <algorithm>

#include "hw/program/options.h"
#include "model/base/error.h"

namespace cuboct {

constexpr BuildPart kStudies{"studies", "configure with -DCUBOCT_STUDIES=ON", CUBOCT_HAS_STUDIES};
constexpr BuildPart kFits{"fits", "configure with -DCUBOCT_FITS=ON", CUBOCT_HAS_FITS};
constexpr BuildPart kBondFits{"fits of Tersoff's potential",
                              "install NLopt (libnlopt-dev) and configure anew", CUBOCT_HAS_BOND_FITS};
constexpr BuildPart kLearning{"studies and NLopt", "configure with -DCUBOCT_STUDIES=ON", CUBOCT_HAS_LEARNING};
constexpr BuildPart kSynthesis{"synthesis", "configure with -DCUBOCT_SYNTH=ON", CUBOCT_HAS_SYNTH};
constexpr BuildPart kView{"the page of a run",
                          "install libmicrohttpd (libmicrohttpd-dev) and configure with -DCUBOCT_VIEW=ON",
                          CUBOCT_HAS_VIEW};

namespace {

constexpr std::string_view kCore = "cuboct", kMachine = "cuboct-machine", kStudy = "cuboct-study";
constexpr CommandRow kCommands[] = {
    {"new", "write a commented scene to start from", kCore, nullptr},
    {"check", "read a scene and print what a run of it does and takes", kCore, nullptr},
    {"run", "run a scene and end with a summary", kCore, nullptr},
    {"crosscheck", "run a scene in several engines and compare every bit", kCore, nullptr},
    {"emit", "write the scene's machine as a self-contained RTL project", kMachine, nullptr},
    {"synth", "what an emitted project takes on an FPGA or in standard cells", kMachine, &kSynthesis},
    {"energy", "joules, watts and area of a scene's machine, in bands", kMachine, nullptr},
    {"boards", "cuts a scene's machine into devices: pins, latency, exact cycles", kMachine, nullptr},
    {"elastic", "elastic constants, by lattice sums and by strained simulation", kStudy, nullptr},
    {"multiscale", "stretch or strike a body whose elements carry their atoms", kStudy, nullptr},
    {"explore", "chart a study's settings or machines: errors, speed, energy", kStudy, &kStudies},
    {"fit", "find the force law of a curve, or the potential of a crystal", kStudy, &kFits},
    {"learn", "learn a linear peridynamic solid from a sheet of atoms", kStudy, &kLearning},
    {"pitch", "find the pitch that keeps a figure within an error", kStudy, &kStudies},
    {"stability", "measure the largest stable time step, beside what theory says", kStudy, &kStudies},
    {"bench", "measure how fast the engines are", "cuboct-bench", nullptr},
    {"curves", "write what the probes of a run read as comma-separated values", kCore, nullptr},
    {"measure", "radial distribution, displacement, structure, stress of a run", kCore, nullptr},
    {"state", "write the end of a run as a file that a scene can start from", kCore, nullptr},
    {"picture", "draw the frames of a run's directory, of bodies of any size", kCore, nullptr},
    {"view", "a run in 3D in a browser, while it goes and afterwards", "cuboct-view", &kView},
    {"report", "make one HTML file of a run's directory", kCore, nullptr},
};

}  // namespace

void refuse_left_out(const std::string& asked, const BuildPart& part) {
  throw InputError(fmt::format("{}: this cuboct was built without {}", asked, part.name),
                   std::string(part.cure));
}

std::span<const CommandRow> command_rows() { return kCommands; }

Command add_command(Command& app, std::string_view name) {
  const CommandRow& row = *std::ranges::find(kCommands, name, &CommandRow::name);
  return app.command(std::string(row.name), std::string(row.about));
}

}  // namespace cuboct
