// SPDX-License-Identifier: MIT
#include "synth/flow.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "synth/estimate.h"
#include "synth/script.h"
#include "synth/stage_time.h"
#include "synth/stages.h"
#include "synth/tool.h"

namespace cuboct::synth {
namespace {

namespace fs = std::filesystem;

// A directory that becomes the results as a whole, or goes.
class Pending {
 public:
  explicit Pending(const std::string& final)
      : final_(final), path_(fmt::format("{}.{}.tmp", final, getpid())) {
    make_directory(path_);
  }
  ~Pending() {
    std::error_code none;
    fs::remove_all(path_, none);
    // And what was made above it, where nothing came of it: DIR/synth/TARGET.
    const fs::path target = fs::path(path_).parent_path();
    if (fs::remove(target, none)) fs::remove(target.parent_path(), none);
  }
  Pending(const Pending&) = delete;
  Pending& operator=(const Pending&) = delete;

  const std::string& path() const { return path_; }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
  // Puts itself in the place of what is there.
  void become(const std::string& place) {
    const std::string old = path_ + ".old";
    if (fs::exists(place)) fs::rename(place, old);
    fs::rename(path_, place);
    fs::remove_all(old);
  }
  void done() {
    fs::remove_all(final_ + ".failed");
    become(final_);
  }
  void failed() { become(final_ + ".failed"); }

 private:
  std::string final_, path_;
};

constexpr const char* kOsu018 = "/usr/share/qflow/tech/osu018/osu018_stdcells.lib";

std::string numbers(const Target& target, const Counts& used) {
  std::string text;
  for (const Resource r : resources_of(target.family))
    if (used[r] > 0)
      text += fmt::format("{}{} {}/{}", text.empty() ? "" : ", ", to_string(r), used[r], target.holds[r]);
  return text;
}

InputError no_room(const Report& report, const Target& target, const std::string& why) {
  return InputError(fmt::format("{} does not fit {}: {}", report.unit, target.name, why), elsewhere(report));
}

constexpr const char* kElaboration = "elaboration";
constexpr const char* kSynthesis = "synthesis";
constexpr const char* kEstimate = "clock estimate";
constexpr const char* kPlacement = "placement";
constexpr const char* kBitstream = "bitstream";
constexpr const char* kTiming = "timing";
constexpr const char* kPower = "power";

bool places(const Request& request, const Target& target) {
  return request.place && (target.family == Family::ice40 ||
                           (target.family == Family::ecp5 && in_path("nextpnr-ecp5") && in_path("ecppack")));
}

// The clock before anything is placed is told where OpenSTA is installed.
const Delays* delays_to_estimate(const Target& target) {
  return in_path("sta") ? delays_of(target) : nullptr;
}

std::vector<std::string> stages_of(const Request& request, const Target& target) {
  std::vector<std::string> names = {kElaboration, kSynthesis};
  if (target.family == Family::asic) names.insert(names.end(), {kTiming, kPower});
  if (delays_to_estimate(target)) names.push_back(kEstimate);
  if (places(request, target)) names.push_back(kPlacement);
  if (places(request, target) && target.family == Family::ice40) names.push_back(kBitstream);
  return names;
}

class Flow {
 public:
  Flow(const Request& request, const Target& target, Project project, const std::string& out,
       const Told& told)
      : request_(request),
        target_(target),
        project_(std::move(project)),
        out_(out),
        tools_(out,
               [this, &told](const std::string& what, int seconds) {
                 const std::string time = stages_.expected();
                 told.says(fmt::format("{}, {} s{}", what, seconds, time.empty() ? "" : " (" + time + ")"));
               }),
        stages_(out, kept_in_cache("synth"), stages_of(request, target), told.tells) {
    for (const char* stage : {kEstimate, kBitstream, kTiming, kPower}) stages_.expect(stage, "seconds");
    // yosys reads a lattice of thousands of nodes for minutes.
    if (request.unit != "lattice" && request.unit != "board") stages_.expect(kElaboration, "seconds");
    report_.plan = project_.plan;
    report_.nodes = project_.nodes;
    report_.particles = project_.particles;
    report_.cycles = project_.cycles;
    report_.target = target.name;
    report_.device = target.family == Family::asic ? fs::path(liberty()).stem().string() : target.device;
    report_.unit = request.unit;
    report_.holds = target.holds;
  }

  Report& report() { return report_; }
  std::string kept() const { return stages_.kept(); }

  // Leaves the unit's counts in the report.
  void synthesise() {
    need("yosys");
    const bool asic = target_.family == Family::asic;
    if (asic) need("sta");
    const CostOf costs = asic ? costs_of_liberty(liberty()) : costs_of(target_.family);
    report_.tools.push_back(first_line("yosys", "-V"));
    Synthesis s;
    s.out = out_;
    const bool board = request_.unit == "board", lattice = request_.unit == "lattice";
    Synthesis named;  // the same wherever the project lies
    if (board) {
      const Board b = read_board(project_);
      named.files = b.files;
      s.top = b.top;
      pins_ = project_.directory + "/" + b.pins;
      s.harness = false;
    } else {
      named.files = project_.files;
      // A node does not need it, and yosys reads that of thousands of nodes for minutes.
      if (!lattice)
        std::erase_if(named.files, [&](const std::string& file) {
          return fs::path(file).filename() == project_.prefix + "cuboct_lattice.sv";
        });
      s.top = project_.prefix + (lattice ? "cuboct_lattice" : "cuboct_node");
    }
    s.files = below(named.files);
    tools_.write("elaborate.ys", elaborate_script(s.files, s.top, out_));
    for (const std::string& file : s.files) key_.add_code(read_text(file));
    key_.add(report_.tools.back());
    InputKey elaboration = key_;
    elaboration.add(elaborate_script(named.files, s.top, ""));
    stages_.make(kElaboration, elaboration, [&] {
      tools_.run("yosys reads the project", "elaborate", "yosys", {out_ + "/elaborate.ys"});
    });
    const Design design = read_design(tools_.path("elaborated.json"), project_.prefix);
    s.module = board || lattice ? design.top : module_of(design, request_.unit);
    s.unit = base_name(s.module);
    if (lattice) s.kept = project_.prefix + "cuboct_node";
    if (asic) {
      s.harness = false;
      const auto& ports = design.modules.at(s.module).ports;
      if (std::none_of(ports.begin(), ports.end(), [](const Port& p) { return p.name == "clk_i"; }))
        throw InputError(
            fmt::format("the block '{}' has no clock, so no time can be told of it", request_.unit));
    }
    if (s.harness) {
      const Harness harness = make_harness(s.unit, design.modules.at(s.module).ports);
      write_input("harness.v", harness.text);
      report_.harness = harness.flip_flops;
    }
    top_ = s.harness ? kHarness : s.unit;
    if (target_.family == Family::ecp5) write_input("read_side.v", read_side_module());
    if (asic) write_input("abc.constr", "set_load 0.02 [all_outputs]\n");  // pF: one or two inputs
    if (asic) key_.add(read_text(liberty()));
    const auto script = [&](const Synthesis& of) {
      return asic ? asic_script(of, liberty()) : fpga_script(of, target_);
    };
    tools_.write("synth.ys", script(s));
    std::swap(named.files, s.files);
    std::swap(named.out, s.out);
    key_.add(script(s));
    const uint64_t bits = bits_below(design, s.module);
    stages_.expect(kSynthesis, synthesis_time(target_.family, bits));
    stages_.found(fmt::format("{} modules, {} bits of cells", design.modules.size(), bits));
    fs::remove(tools_.path("elaborated.json"));
    stages_.make(kSynthesis, key_,
                 [&] { tools_.run("yosys synthesises", "yosys", "yosys", {out_ + "/synth.ys"}); });
    report_.block = read_netlist(tools_.path("netlist.json"), s.unit, design, s.module, costs);
    report_.used = count_all(tools_.path("netlist.json"), top_, costs);
    report_.depth = read_depth(read_text(tools_.path("yosys.log")));
    stages_.found(asic ? fmt::format("{} gates, {:.3f} mm^2", report_.used[Resource::gates],
                                     static_cast<double>(report_.used[Resource::area]) / 1e6)
                       : numbers(target_, report_.used));
  }

  // Throws InputError where the unit alone has no room.
  void check_room() const {
    if (target_.family == Family::asic) return;
    for (const Resource r : resources_of(target_.family))
      if (report_.used[r] > target_.holds[r]) throw no_room(report_, target_, numbers(target_, report_.used));
  }

  void estimate() {
    const Delays* delays = delays_to_estimate(target_);
    if (!delays) return;
    constexpr size_t kEnds = 500;  // registers whose longest path is looked at
    const Timer timer(tools_.path("netlist.json"), top_, *delays);
    if (timer.clocks().empty()) return;
    InputKey key;
    for (const auto& [file, text] : {std::pair{"cells.lib", timer.library()},
                                     {"timed.v", timer.netlist()},
                                     {"wires.sdf", timer.wires()}}) {
      tools_.write(file, text);
      key.add(text);
    }
    tools_.write("estimate.tcl", Timer::script(out_, timer.clocks(), kEnds));
    key.add(Timer::script("", timer.clocks(), kEnds)).add(first_line("sta", "-version"));
    stages_.make(kEstimate, key, [&] {
      tools_.run("sta looks for the longest path", "estimate", "sta",
                 {"-no_splash", "-exit", tools_.path("estimate.tcl")});
      check_sta("estimate.log");
    });
    report_.estimate = summary(timer.read(read_text(tools_.path("estimate.log"))), *delays);
    stages_.found(report_.estimate ? fmt::format("{:.1f} MHz", report_.estimate->mhz()) : "no path");
    for (const char* file : {"cells.lib", "timed.v", "wires.sdf"}) fs::remove(tools_.path(file));
  }

  void place_ice40() {
    const std::string asc = tools_.path("unit.asc"), timing = tools_.path("timing.json");
    std::vector<std::string> arguments = {"--" + target_.name,
                                          "--package",
                                          target_.package,
                                          "--json",
                                          tools_.path("netlist.json"),
                                          "--top",
                                          top_,
                                          "--freq",
                                          fmt::format("{:g}", frequency()),
                                          "--seed",
                                          std::to_string(request_.seed),
                                          "--timing-allow-fail",
                                          "--asc",
                                          asc,
                                          "--report",
                                          timing};
    if (!pins_.empty()) arguments.insert(arguments.end(), {"--pcf", pins_});
    report_.tools.push_back(first_line("nextpnr-ice40", "--version"));
    InputKey key = key_;
    key.add(target_.name).add(target_.package).add(fmt::format("{:g}", frequency()));
    key.add(std::to_string(request_.seed)).add(pins_text()).add(report_.tools.back());
    try {
      stages_.make(kPlacement, key, [&] {
        tools_.run("nextpnr-ice40 places and routes", "nextpnr", "nextpnr-ice40", arguments);
      });
    } catch (const ToolFailed&) {
      std::string why;
      bool full = false;
      const auto packed = read_utilisation(read_text(tools_.path("nextpnr.log")));
      for (const auto& [kind, use] : packed) {
        if (use.used == 0 || !kind.starts_with("ICESTORM_")) continue;
        full = full || use.used > use.available;
        why += fmt::format("{}{} {}/{}", why.empty() ? "" : ", ", kind, use.used, use.available);
      }
      if (full) {
        report_.pack(packed);
        throw no_room(report_, target_, why);
      }
      throw;
    }
    report_.take(read_nextpnr_report(timing), fmt::format("nextpnr-ice40, seed {}", request_.seed));
    tell_placed();
    stages_.make_again(kBitstream, [&] {
      tools_.run("icepack writes the bitstream", "icepack", "icepack", {asc, tools_.path("unit.bin")});
      tools_.run("icetime looks again", "icetime", "icetime", {"-m", "-t", "-d", target_.name, asc});
    });
    report_.icetime = read_icetime(read_text(tools_.path("icetime.log")));
    stages_.found(report_.icetime ? fmt::format("{:.2f} MHz by icetime", *report_.icetime) : "unit.bin");
  }

  void place_ecp5() {
    if (!pins_.empty()) fs::copy_file(pins_, tools_.path("pins.lpf"));
    const std::string script = place_script(target_, top_, frequency(), request_.seed, pins_);
    tools_.write("place.sh", script);
    fs::permissions(tools_.path("place.sh"),
                    fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                    fs::perm_options::add);
    if (!places(request_, target_)) return;
    report_.tools.push_back(first_line("nextpnr-ecp5", "--version"));
    InputKey key = key_;
    key.add(script).add(pins_text()).add(report_.tools.back()).add(first_line("ecppack", "--version"));
    stages_.make(kPlacement, key, [&] {
      tools_.run("nextpnr-ecp5 places and routes", "place", "sh",
                 {"-c", "cd \"$1\" && exec ./place.sh", "sh", fs::absolute(out_).string()});
    });
    report_.take(read_nextpnr_report(tools_.path("timing.json")),
                 fmt::format("nextpnr-ecp5, seed {}", request_.seed));
    tell_placed();
  }

  // Once for the time, once for the power at the clock that this allows.
  void time_asic() {
    constexpr double kFirst = 1000;  // ns; longer than any path
    Silicon s;
    s.library = fs::path(liberty()).filename().string();
    s.activity = request_.activity;
    s.area = static_cast<double>(report_.block.counts[Resource::area]);
    const auto sta = [&](const std::string& stage, double period) {
      const std::string log = stage + ".log", script = stage + ".tcl";
      tools_.write(script, sta_script(liberty(), tools_.path("netlist.v"), top_, period, s.activity));
      InputKey key = key_;
      key.add(sta_script(liberty(), "", top_, period, s.activity)).add(first_line("sta", "-version"));
      stages_.make(stage, key, [&] {
        tools_.run("sta times the gates", stage, "sta", {"-no_splash", "-exit", tools_.path(script)});
        check_sta(log);
      });
      const auto analysed = read_sta(read_text(tools_.path(log)));
      if (!analysed) throw ToolFailed("sta", log, complaint_of(read_text(tools_.path(log))));
      return *analysed;
    };
    s.delay = kFirst - sta(kTiming, kFirst).slack;
    s.frequency = 1000 / s.delay;
    stages_.found(fmt::format("{:.2f} ns, {:.1f} MHz", s.delay, s.frequency));
    s.power = sta(kPower, s.delay).power;
    stages_.found(fmt::format("{:.3g} W", s.power));
    report_.silicon = s;
    report_.fmax = s.frequency;
    report_.fmax_from = "OpenSTA, without wires";
  }

 private:
  // A file that yosys reads beside the sources.
  void write_input(const std::string& name, const std::string& text) {
    tools_.write(name, text);
    key_.add(text);
  }
  // sta goes on after an error, with exit status 0.
  void check_sta(const std::string& log) const {
    const std::string text = read_text(tools_.path(log));
    if (text.find("\nError:") != std::string::npos) throw ToolFailed("sta", log, complaint_of(text));
  }
  void tell_placed() {
    stages_.found(report_.fmax ? fmt::format("Fmax {:.2f} MHz", *report_.fmax) : "no clock");
  }
  std::string pins_text() const { return pins_.empty() ? "" : read_text(pins_); }

  std::vector<std::string> below(const std::vector<std::string>& files) const {
    std::vector<std::string> paths;
    for (const std::string& f : files) paths.push_back(project_.directory + "/" + f);
    return paths;
  }
  std::string liberty() const { return request_.liberty.empty() ? kOsu018 : request_.liberty; }
  double frequency() const { return request_.frequency > 0 ? request_.frequency : target_.frequency; }

  const Request& request_;
  const Target& target_;
  Project project_;
  std::string out_, top_, pins_;
  Runner tools_;
  Stages stages_;
  InputKey key_;  // of the netlist, once it is there
  Report report_;
};

void store(Pending& pending, Report& report) {
  write_text(pending.path() + "/table.txt", print_table(report));
  write_text(pending.path() + "/report.json", "");  // so that it is among its files
  report.files = pending.files();
  write_text(pending.path() + "/report.json", report_json(report) + "\n");
}

// Whether a placer saw the netlist that the report is of.
void check_same(const Placed& placed, const Report& report, const std::string& file) {
  for (const auto& [kind, resource] :
       {std::pair{"TRELLIS_FF", Resource::ff}, std::pair{"MULT18X18D", Resource::dsp},
        std::pair{"DP16KD", Resource::bram}}) {
    const auto use = placed.use.find(kind);
    const uint64_t used = use == placed.use.end() ? 0 : use->second.used;
    if (used != report.used[resource])
      throw InputError(fmt::format("{}: is of another netlist: {} {} there, {} here", file, used, kind,
                                   report.used[resource]),
                       "place the netlist.json that is here");
  }
}

// What a run before this one left, with what a placer said of it elsewhere.
Report add_timing(const Request& request, const Target& target, const Project& project) {
  const std::string results = results_directory(request);
  if (target.family != Family::ecp5)
    throw InputError(
        fmt::format("--timing is for ecp5-25 and ecp5-85: {} is placed here or not at all", target.name));
  const Placed placed = read_nextpnr_report(request.timing);
  if (!fs::exists(results + "/report.json"))
    throw InputError(fmt::format("{}: holds no synthesis yet", results),
                     "run the command without --timing first");
  Report report = read_report(results + "/report.json");
  if (report.plan != project.plan)
    throw InputError(fmt::format("{}: is of plan {}, the project of {}", results, report.plan, project.plan),
                     "run the command without --timing first");
  check_same(placed, report, request.timing);
  report.take(placed, "nextpnr-ecp5, elsewhere");
  Pending pending(results);
  const fs::copy_options over = fs::copy_options::overwrite_existing;
  for (const auto& entry : fs::directory_iterator(results))
    fs::copy_file(entry, fs::path(pending.path()) / entry.path().filename(), over);
  fs::copy_file(request.timing, pending.path() + "/timing.json", over);
  store(pending, report);
  pending.done();
  return report;
}

}  // namespace

std::string results_directory(const Request& request) {
  std::string unit = request.unit;
  std::replace(unit.begin(), unit.end(), '#', '_');
  return fmt::format("{}/synth/{}/{}", request.directory, request.target, unit);
}

Report synthesise(const Request& request, const Told& told) {
  const Target& target = target_of(request.target);
  Project project = read_project(request.directory);
  if (!request.timing.empty()) return add_timing(request, target, project);
  catch_interrupts();
  Pending pending(results_directory(request));
  Flow flow(request, target, std::move(project), pending.path(), told);
  if (target.family == Family::asic && request.liberty.empty() && !fs::exists(kOsu018))
    throw InputError(fmt::format("{} is not there", kOsu018),
                     "apt-get install qflow-tech-osu018, or --liberty FILE");
  try {
    flow.synthesise();
    try {
      flow.check_room();
      flow.estimate();
      if (target.family == Family::ice40 && request.place) flow.place_ice40();
      if (target.family == Family::ecp5) flow.place_ecp5();
      if (target.family == Family::asic) flow.time_asic();
    } catch (const InputError&) {
      // What it takes is worth knowing all the same.
      store(pending, flow.report());
      pending.done();
      throw;
    }
  } catch (const ToolFailed&) {
    pending.failed();
    throw;
  } catch (Interrupted& stop) {
    stop.kept = flow.kept();
    throw;
  }
  store(pending, flow.report());
  pending.done();
  return flow.report();
}

}  // namespace cuboct::synth
