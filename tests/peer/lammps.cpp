// SPDX-License-Identifier: MIT
#include "tests/peer/lammps.h"
#include "tests/support/folder.h"

#include <fmt/format.h>
#include <fmt/os.h>
#include <unistd.h>

#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// Numbers travel as text with 17 significant digits, which keeps every bit of a double.
std::string data_file(const LammpsRun& run, const Body& body) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Vec3& x : body.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
  std::string text = fmt::format("\n\n{} atoms\n{} atom types\n", body.size(), run.types);
  for (int axis = 0; axis < 3; ++axis) {
    const bool ring = run.periodic.extent[axis] > 0;
    const double room = 2 * (high[axis] - low[axis]) + 10;
    const double begin = ring ? run.periodic.origin[axis] : low[axis] - room;
    const double end = ring ? begin + run.periodic.extent[axis] : high[axis] + room;
    text += fmt::format("{0:.17g} {1:.17g} {2}lo {2}hi\n", begin, end, "xyz"[axis]);
  }
  text += "\nMasses\n\n";
  for (int type = 1; type <= run.types; ++type) text += fmt::format("{} {:.17g}\n", type, run.mass);
  text += "\nAtoms # atomic\n\n";
  for (size_t i = 0; i < body.size(); ++i) {
    text += fmt::format("{} {} {:.17g} {:.17g} {:.17g}\n", i + 1, body.type[i] + 1, body.x[i].x(),
                        body.x[i].y(), body.x[i].z());
  }
  text += "\nVelocities\n\n";
  for (size_t i = 0; i < body.size(); ++i) {
    text += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", i + 1, body.v[i].x(), body.v[i].y(), body.v[i].z());
  }
  return text;
}

constexpr const char* kDump = R"(compute virial all stress/atom NULL virial
dump frames all custom {} frames.txt id xu yu zu vx vy vz fx fy fz c_virial[1] c_virial[2] c_virial[3] c_virial[4] c_virial[5] c_virial[6]
dump_modify frames sort id format float %.17g
)";

// As far as the pairs.
std::string begin_of_input(const LammpsRun& run) {
  const auto boundary = [&](int axis) { return run.periodic.extent[axis] > 0 ? 'p' : 'f'; };
  return fmt::format(R"(units lj
boundary {} {} {}
atom_style atomic
newton on
read_data body.data
{}
)",
                     boundary(0), boundary(1), boundary(2), run.pair);
}

std::string input_file(const LammpsRun& run, bool frames) {
  return begin_of_input(run) + fmt::format(R"(neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {:.17g}
{}thermo_style custom step pe ke press
thermo_modify norm no format float "energies %.17g"
thermo {}
fix nve all nve
run {}
)",
                                           run.dt, frames ? fmt::format(kDump, run.steps) : "",
                                           frames ? run.steps : run.every, run.steps);
}

// Axes that do not repeat get a box well around the atoms.
std::string data_file(const LammpsAtoms& atoms) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Vec3& x : atoms.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
  std::string text = fmt::format("\n\n{} atoms\n{} atom types\n", atoms.x.size(), atoms.elements);
  const Mat3& edges = atoms.box.edges;
  for (int axis = 0; axis < 3; ++axis) {
    const bool ring = atoms.box.periodic[axis];
    const double begin = ring ? 0 : low[axis] - 10, end = ring ? edges(axis, axis) : high[axis] + 10;
    text += fmt::format("{0:.17g} {1:.17g} {2}lo {2}hi\n", begin, end, "xyz"[axis]);
  }
  text +=
      fmt::format("{:.17g} {:.17g} {:.17g} xy xz yz\n\nMasses\n\n", edges(0, 1), edges(0, 2), edges(1, 2));
  for (int type = 1; type <= atoms.elements; ++type) text += fmt::format("{} {:.17g}\n", type, atoms.mass);
  text += "\nAtoms # atomic\n\n";
  for (size_t i = 0; i < atoms.x.size(); ++i) {
    const int type = atoms.element.empty() ? 1 : atoms.element[i] + 1;
    text += fmt::format("{} {} {:.17g} {:.17g} {:.17g}\n", i + 1, type, atoms.x[i].x(), atoms.x[i].y(),
                        atoms.x[i].z());
  }
  return text;
}

constexpr const char* kForces = R"(units metal
boundary {} {} {}
atom_style atomic
newton on
box tilt large
read_data atoms.data
{}
neighbor 0.3 bin
thermo_style custom step pe
thermo_modify norm no format float "energies %.17g"
compute virial all stress/atom NULL virial
timestep {:.17g}
{}
dump frames all custom {} frames.txt id xu yu zu fx fy fz c_virial[1] c_virial[2] c_virial[3] c_virial[4] c_virial[5] c_virial[6]
dump_modify frames sort id format float %.17g
run {}
)";
// LAMMPS's bar angstrom^3 of an eV.
constexpr double kLammpsPressure = 1.6021765e6;

void run_in(const Folder& scratch) {
  const std::string command =
      fmt::format("cd '{}' && OMP_NUM_THREADS=1 '{}' -in in.lmp -log none > out.txt 2>&1",
                  scratch.path().string(), CUBOCT_LMP);
  if (std::system(command.c_str()) != 0)
    throw std::runtime_error("LAMMPS failed:\n" + scratch.read("out.txt"));
}

// Runs LAMMPS in the scratch directory.
std::vector<LammpsSample> samples_of(const LammpsRun& run, const Body& body, const Folder& scratch,
                                     bool frames) {
  scratch.write("body.data", data_file(run, body));
  scratch.write("in.lmp", input_file(run, frames));
  for (const auto& [name, text] : run.files) scratch.write(name, text);
  run_in(scratch);
  // The lines "step energies pe energies ke energies press" of the output.
  std::vector<LammpsSample> samples;
  std::istringstream out(scratch.read("out.txt"));
  for (std::string line; std::getline(out, line);) {
    std::istringstream words(line);
    LammpsSample sample;
    std::string a, b, c;
    if (words >> sample.step >> a >> sample.potential_energy >> b >> sample.kinetic_energy >> c >>
            sample.pressure &&
        a == "energies" && b == a && c == a)
      samples.push_back(sample);
  }
  return samples;
}

}  // namespace

bool have_lammps() { return *CUBOCT_LMP != '\0'; }

std::vector<LammpsFrame> run_lammps(const LammpsRun& run, const Body& body) {
  const Folder scratch;
  const std::vector<LammpsSample> samples = samples_of(run, body, scratch, true);
  std::vector<LammpsFrame> frames;
  std::istringstream text(scratch.read("frames.txt"));
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("ITEM: ATOMS", 0) != 0) continue;
    LammpsFrame frame;
    for (size_t i = 0; i < body.size(); ++i) {
      size_t id = 0;
      Vec3 x, v, f;
      double s[6];
      text >> id >> x[0] >> x[1] >> x[2] >> v[0] >> v[1] >> v[2] >> f[0] >> f[1] >> f[2];
      for (double& component : s) text >> component;  // xx, yy, zz, xy, xz, yz
      if (!text || id != i + 1) throw std::runtime_error("LAMMPS wrote a broken frame");
      frame.x.push_back(x);
      frame.v.push_back(v);
      frame.f.push_back(f);
      Mat3 virial;
      virial << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
      frame.virial.push_back(virial);
    }
    frames.push_back(std::move(frame));
  }
  if (frames.size() != (run.steps > 0 ? 2 : 1)) {
    throw std::runtime_error(fmt::format("LAMMPS wrote {} frames", frames.size()));
  }
  if (samples.size() < frames.size()) throw std::runtime_error("LAMMPS wrote no energies");
  for (size_t k = 0; k < frames.size(); ++k) {
    frames[k].potential_energy = samples[k].potential_energy;
    frames[k].kinetic_energy = samples[k].kinetic_energy;
  }
  return frames;
}

std::vector<std::string> ask_lammps(const LammpsRun& run, const Body& body, const std::string& lines,
                                    const std::vector<std::string>& files) {
  const Folder scratch;
  scratch.write("body.data", data_file(run, body));
  scratch.write("in.lmp", begin_of_input(run) + lines);
  run_in(scratch);
  std::vector<std::string> texts;
  for (const std::string& file : files) texts.push_back(scratch.read(file));
  return texts;
}

LammpsForces lammps_forces(const LammpsAtoms& atoms) {
  const Folder scratch;
  scratch.write("atoms.data", data_file(atoms));
  const auto boundary = [&](int axis) { return atoms.box.periodic[axis] ? 'p' : 'f'; };
  scratch.write("in.lmp", fmt::format(kForces, boundary(0), boundary(1), boundary(2), atoms.pair, atoms.dt,
                                      atoms.moves, std::max(1, atoms.steps), atoms.steps));
  run_in(scratch);
  LammpsForces forces;
  std::istringstream text(scratch.read("frames.txt"));
  std::string line;
  // The last frame.
  for (int frame = atoms.steps > 0 ? 2 : 1; frame > 0; --frame)
    while (std::getline(text, line) && line.rfind("ITEM: ATOMS", 0) != 0) {
    }
  double sum[6] = {};
  for (size_t i = 0; i < atoms.x.size(); ++i) {
    size_t id = 0;
    Vec3 x, f;
    text >> id >> x[0] >> x[1] >> x[2] >> f[0] >> f[1] >> f[2];
    for (double& component : sum) {
      double of = 0;
      text >> of;
      component += of / kLammpsPressure;
    }
    if (!text || id != i + 1) throw std::runtime_error("LAMMPS wrote a broken frame");
    forces.x.push_back(x);
    forces.f.push_back(f);
  }
  forces.virial << sum[0], sum[3], sum[4], sum[3], sum[1], sum[5], sum[4], sum[5], sum[2];
  std::istringstream out(scratch.read("out.txt"));
  std::string word;
  for (long step = 0; std::getline(out, line);) {
    std::istringstream words(line);
    if (words >> step >> word >> forces.energy && word == "energies" && step == atoms.steps) return forces;
  }
  throw std::runtime_error("LAMMPS wrote no energy");
}

std::vector<LammpsSample> sample_lammps(const LammpsRun& run, const Body& body) {
  const Folder scratch;
  std::vector<LammpsSample> samples = samples_of(run, body, scratch, false);
  const int expected = run.steps / run.every + 1;
  if (static_cast<int>(samples.size()) < expected)
    throw std::runtime_error(fmt::format("LAMMPS wrote {} samples, not {}:\n{}", samples.size(), expected,
                                         scratch.read("out.txt")));
  return samples;
}

}  // namespace cuboct::test
