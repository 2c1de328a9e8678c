// SPDX-License-Identifier: MIT
#include "cli/study/explore_machines.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "cli/machine/emit.h"
#include "cli/machine/technologies.h"
#include "cli/study/machine_devices.h"
#include "cli/study/study_command.h"
#include "hw/engine/scene_engine.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "model/config/changes.h"
#include "study/machines/machine_evolution.h"
#include "study/machines/machine_front.h"
#include "study/machines/machine_page.h"
#include "study/machines/machine_table.h"
#include "study/report/page.h"

namespace cuboct {
namespace {

using study::MachineChoice;
using study::MachineFinding;
using study::MachineStudy;
using study::Verdict;

// Machines that are synthesised, in the order of the first objective, until one is known to keep all.
constexpr size_t kMostSyntheses = 8;
// Lines of the front that are printed; machines.tsv has all.
constexpr size_t kMostLines = 20;

study::MachineNames names() {
  return {
      technology_named,
      [](Technology technology, const std::string& link) { return with_link(std::move(technology), link); },
      fpga_names()};
}

// What `cuboct run SCENE --arch` would be given.
study::Case case_of(const MachineStudy& study, const MachineChoice& choice) {
  return study::resolve(study.scenes[choice.scene], choice.settings);
}

Setup setup_of(const study::Case& c) {
  return with_places(c.scene, c.arch, [&] { return machine_setup(c.scene, c.arch); });
}

class Exploration {
 public:
  Exploration(const ExploreMachines& options, const Answer& answer)
      : options_(options), answer_(answer), study_(study::read_machine_study(options.study, names())) {}

  int run() {
    if (!options_.emit.empty()) check_emit_directory(options_.emit);
    return kept_in(options_.out, "cuboct explore", [this] { return found(); });
  }

 private:
  int found() {
    find();
    const std::optional<size_t> best = options_.best ? choose() : std::nullopt;
    report();
    std::string chosen = "null";
    int code = 0;
    if (options_.best) {
      code = best ? 0 : 1;
      if (best)
        chosen = tell_best(*best);
      else
        tell_none();
    }
    answer_.close(json_object(
        {{"directory", json(options_.out)},
         {"machines", std::to_string(findings_.size())},
         {"refused", std::to_string(refused())},
         {"front", json_array(front_, [&](size_t n) { return study::machine_json(study_, findings_[n]); })},
         {"chosen", chosen},
         {"emitted", best && !options_.emit.empty() ? json(options_.emit) : "null"}}));
    return code;
  }

  void find() {
    study::MachineRunner runner(study_,
                                {options_.out + "/machines.jsonl", options_.jobs, true, estimated_use});
    findings_ = runner.evaluate(study_.points, study_.steps);
    if (study_.evolution) {
      study::Evolved evolved = study::evolve_machines(study_, runner);
      visited_ = evolved.visited;
      findings_.insert(findings_.end(), std::make_move_iterator(evolved.front.begin()),
                       std::make_move_iterator(evolved.front.end()));
    }
    if (study_.frame.figures.empty()) return;
    study::Store store(options_.out + "/results.db", study_.frame);
    study::Runner errors(study_.frame, store, {.jobs = options_.jobs, .speed = false});
    errors.truth();
    runner.add_errors(findings_, errors);
  }

  size_t refused() const {
    return static_cast<size_t>(
        std::ranges::count_if(findings_, [](const MachineFinding& f) { return !f.done(); }));
  }

  // Puts what synthesis counts in the place of its estimates.
  void synthesise(size_t n) {
    MachineFinding& f = findings_[n];
    const study::Case c = case_of(study_, f.choice);
    const Setup setup = setup_of(c);
    const auto take = [&](const study::DeviceUse& use) {
      f.values[static_cast<size_t>(study::MachineQuantity::lut)] = use.lut;
      f.values[static_cast<size_t>(study::MachineQuantity::ff)] = use.ff;
      f.values[static_cast<size_t>(study::MachineQuantity::dsp)] = use.dsp;
      f.values[static_cast<size_t>(study::MachineQuantity::bram)] = use.bram;
    };
    if (!f.choice.target.empty()) take(synthesised_use(setup, f.choice.target));
    for (size_t k = 0; k < study_.constraints.size(); ++k) {
      const study::MachineConstraint& constraint = study_.constraints[k];
      if (!constraint.target.empty()) {
        const study::DeviceUse use = synthesised_use(setup, constraint.target);
        f.kept[k] = use.share;
        if (f.choice.target.empty()) take(use);
      }
    }
    for (size_t k = 0; k < study_.constraints.size(); ++k)
      if (study_.constraints[k].target.empty()) f.kept[k] = f.values[study_.constraints[k].measure];
  }

  bool has_device(const MachineFinding& f) const {
    return !f.choice.target.empty() ||
           std::ranges::any_of(study_.constraints, [](const auto& c) { return !c.target.empty(); });
  }
  // Only what synthesis counts can still decide it.
  bool waits_for_synthesis(const MachineFinding& f) const {
    for (size_t k = 0; k < study_.constraints.size(); ++k) {
      const study::MachineConstraint& c = study_.constraints[k];
      const auto quantity = study::quantity_at(c.measure);
      const bool of_device = !c.target.empty() || (quantity >= study::MachineQuantity::lut &&
                                                   quantity <= study::MachineQuantity::bram);
      if (judge(c, f.kept[k]) != Verdict::holds && (!of_device || f.kept[k].known == study::Known::measured))
        return false;
    }
    return true;
  }

  // Cheapest first: machines that an estimate leaves undecided are synthesised, and so is the one that is
  // taken where --confirm asks for it.
  std::optional<size_t> choose() {
    const bool tools = can_synthesise();
    std::vector<MachineFinding> open = findings_;
    for (size_t synthesised = 0;;) {
      for (size_t n = 0; n < open.size(); ++n)
        if (open[n].done() && verdict_of(study_, open[n]) == Verdict::undecided &&
            (!tools || synthesised >= kMostSyntheses || !waits_for_synthesis(open[n])))
          open[n].why = "undecided";
      const std::optional<size_t> best = best_machine(study_, open, Verdict::undecided);
      if (!best) return std::nullopt;
      const bool holds = verdict_of(study_, open[*best]) == Verdict::holds;
      const bool known = open[*best].value(study::MachineQuantity::lut).known == study::Known::measured;
      if (holds &&
          (known || !options_.confirm || !tools || !has_device(open[*best]) || synthesised >= kMostSyntheses))
        return best;
      synthesise(*best);
      ++synthesised;
      open[*best] = findings_[*best];
    }
  }

  void report() {
    front_ = machine_front(study_, findings_);
    std::string aims;
    for (const size_t m : study_.minimise)
      aims += (aims.empty() ? "" : ", ") + study::measure_names(study_.figure_names())[m];
    answer_.say("{} machines, {} refused; cycles are means of {} steps\n", findings_.size(), refused(),
                study_.steps);
    if (study_.evolution)
      answer_.say("the search looked at {} of {:.4g} machines\n", visited_, study_.evolution->space.points());
    say_refusals();
    if (front_.empty())
      answer_.say("no front: no machine has all of {} and breaks no constraint\n", line_text(aims));
    if (!front_.empty()) {
      const std::vector<size_t> some(
          front_.begin(), front_.begin() + static_cast<std::ptrdiff_t>(std::min(front_.size(), kMostLines)));
      answer_.say("the front of {}: {} machines{}\n{}", line_text(aims), front_.size(),
                  some.size() < front_.size() ? fmt::format(", the first {}", kMostLines) : "",
                  machines_lines(study_, findings_, some));
    }
    write_text(options_.out + "/machines.tsv", study::machines_tsv(study_, findings_, front_));
    answer_.say("all: {}/machines.tsv\n", line_text(options_.out));
    draw();
  }

  // Charts need gnuplot; the page does not, but a charting library in the build.
  void draw() {
    const std::vector<study::Peer> peers = study::parse_peers(kMachinePeers, "technologies/machines.toml");
    const study::MachineResults results{study_, findings_, front_, peers};
    if (study::has_page()) {
      write_text(options_.out + "/page.html", study::machine_page_of(results));
      answer_.say("page: {}/page.html\n", line_text(options_.out));
    }
    size_t files = 0;
    if (drawn("charts", [&] {
          files = study::write_charts(study::machine_charts(results), options_.out + "/charts").size();
        }))
      answer_.say("charts: {} in {}/charts\n", files, line_text(options_.out));
  }

  // Each reason once, with how many machines it refuses.
  void say_refusals() {
    std::vector<std::pair<std::string, size_t>> reasons;
    for (const MachineFinding& f : findings_) {
      if (f.done()) continue;
      const auto found = std::ranges::find(reasons, f.why, &std::pair<std::string, size_t>::first);
      if (found == reasons.end())
        reasons.emplace_back(f.why, 1);
      else
        ++found->second;
    }
    for (const auto& [why, count] : reasons) answer_.say("  no machine, {}x: {}\n", count, line_text(why));
  }

  std::string tell_best(size_t n) {
    const MachineFinding& f = findings_[n];
    answer_.say("\nchosen: machine {}, {}\n{}", n + 1, line_text(machine_text(study_, f.choice)),
                machine_report(study_, f));
    if (!study_.constraints.empty()) answer_.say("constraints\n{}", constraints_report(study_, f));
    const study::Case c = case_of(study_, f.choice);
    const std::string head =
        line_text(fmt::format("# Chosen by `cuboct explore {} --best`.", options_.study)) + "\n";
    write_text(options_.out + "/best_arch.toml", head + c.arch_text);
    write_text(options_.out + "/best_scene.toml", with_whole_paths(c.scene_text, c.scene.path));
    answer_.say("  arch             {}/best_arch.toml\n", line_text(options_.out));
    if (!options_.emit.empty()) {
      const Setup setup = setup_of(c);
      const CountedCycles counted{f.counts->steps, f.counts->cycles, f.counts->most};
      Emission emission;
      emission.vector_steps = 8;
      emission.arch = head + c.arch_text;
      emission.counted = counted;
      emit_rtl(setup.plan, setup.initial, options_.emit, emission);
      say_emitted(options_.emit, setup.plan, counted, answer_);
    }
    return machine_json(study_, f);
  }

  void tell_none() {
    answer_.say("\nno machine keeps all constraints\n");
    const std::optional<size_t> nearest = nearest_machine(study_, findings_);
    if (!nearest) return;
    const MachineFinding& f = findings_[*nearest];
    answer_.say("the nearest: machine {}, {}\n{}", *nearest + 1, line_text(machine_text(study_, f.choice)),
                constraints_report(study_, f));
  }

  const ExploreMachines& options_;
  const Answer& answer_;
  MachineStudy study_;
  std::vector<MachineFinding> findings_;
  std::vector<size_t> front_;
  size_t visited_ = 0;
};

}  // namespace

int explore_machines(const ExploreMachines& options, const Answer& answer) {
  return Exploration(options, answer).run();
}

}  // namespace cuboct
