// SPDX-License-Identifier: MIT
#include "study/machines/machine_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/json.h"
#include "model/base/quantity_text.h"
#include "model/base/text.h"

namespace cuboct::study {
namespace {

// TOML's quotes are for files.
std::string bare(const std::string& value) {
  return value.size() >= 2 && value.front() == '"' && value.back() == '"' ? value.substr(1, value.size() - 2)
                                                                          : value;
}

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

std::string cell(std::string text) {
  std::ranges::replace(text, '\t', ' ');
  return line_text(text);
}

using Columns = std::vector<std::string>;

// Keys that some machine sets, in the order of their first.
Columns keys_of(const std::vector<MachineFinding>& findings, std::vector<Change> Settings::*part) {
  Columns keys;
  for (const MachineFinding& f : findings)
    for (const Change& change : f.choice.settings.*part)
      if (std::ranges::find(keys, change.key) == keys.end()) keys.push_back(change.key);
  return keys;
}

std::string value_of(const std::vector<Change>& changes, const std::string& key) {
  for (const Change& change : changes)
    if (change.key == key) return bare(change.value);
  return "";
}

std::string number_cell(double x) { return std::isnan(x) ? "" : fmt::format("{:.6g}", x); }

void add_value(Columns& row, const MachineValue& value) {
  row.push_back(value.there() ? number_cell(value.band.low) : "");
  row.push_back(value.there() && !value.open ? number_cell(value.band.high) : "");
  row.emplace_back(value.there() ? to_string(value.known) : "");
}

std::string line_of(const Columns& cells) {
  std::string line;
  for (const std::string& text : cells) line += (&text == &cells.front() ? "" : "\t") + cell(text);
  return line + "\n";
}

// Resources of a device where some machine has a device.
bool shows(size_t measure, const std::vector<MachineFinding>& findings) {
  return std::ranges::any_of(findings, [&](const MachineFinding& f) {
    return measure < f.values.size() && f.values[measure].there();
  });
}

std::string clock_text(double clock) { return quantity_text(clock, "Hz"); }

}  // namespace

std::string machine_text(const MachineStudy& study, const MachineChoice& choice) {
  std::string text;
  const auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (study.scenes.size() > 1) add(study.scenes[choice.scene].scene_path);
  for (const Change& change : choice.settings.scene) add(change.key + " " + bare(change.value));
  for (const Change& change : choice.settings.arch) add(last_part(change.key) + " " + bare(change.value));
  add(study.technologies[choice.technology].name);
  add(clock_text(choice.clock));
  if (!choice.target.empty()) add(choice.target);
  return text;
}

std::string machines_tsv(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                         const std::vector<size_t>& front) {
  const Columns scene_keys = keys_of(findings, &Settings::scene),
                arch_keys = keys_of(findings, &Settings::arch);
  const Columns names = measure_names(study.figure_names());
  Columns head{"machine", "scene", "technology", "clock, Hz", "target"};
  head.insert(head.end(), scene_keys.begin(), scene_keys.end());
  for (const std::string& key : arch_keys) head.push_back("arch." + key);
  std::vector<size_t> shown;
  for (size_t m = 0; m < names.size(); ++m)
    if (shows(m, findings)) shown.push_back(m);
  for (const size_t m : shown) {
    const QuantityName& name = named(quantity_at(m));
    const std::string label = names[m] + (*name.unit ? std::string(", ") + name.unit : "");
    head.insert(head.end(), {label + ", low", "high", "known"});
  }
  head.insert(head.end(), {"steps counted", "most cycles of a step", "expected cycles"});
  for (size_t k = 0; k < kStepParts; ++k)
    head.push_back(fmt::format("cycles in {}", name_of(static_cast<StepPart>(k))));
  for (size_t k = 0; k < kDemands; ++k)
    head.push_back(fmt::format("cycles that {} need", name_of(static_cast<Demand>(k))));
  head.insert(head.end(), {"bound by", "constraints", "front", "no machine, because"});
  std::string out = line_of(head);
  for (size_t n = 0; n < findings.size(); ++n) {
    const MachineFinding& f = findings[n];
    Columns row{std::to_string(n + 1), study.scenes[f.choice.scene].scene_path,
                study.technologies[f.choice.technology].name, fmt::format("{}", f.choice.clock),
                f.choice.target};
    for (const std::string& key : scene_keys) row.push_back(value_of(f.choice.settings.scene, key));
    for (const std::string& key : arch_keys) row.push_back(value_of(f.choice.settings.arch, key));
    for (const size_t m : shown) add_value(row, f.done() ? f.values[m] : MachineValue());
    if (f.done()) {
      row.insert(row.end(), {std::to_string(f.counts->steps), std::to_string(f.counts->most),
                             std::to_string(f.expected.step)});
      for (const double part : f.counts->parts) row.push_back(number_cell(part));
      for (const double demand : f.counts->demands) row.push_back(number_cell(demand));
      row.insert(row.end(), {bound_of(*f.counts), to_string(verdict_of(study, f)),
                             std::ranges::find(front, n) != front.end() ? "front" : "", ""});
    } else {
      row.insert(row.end(), 3 + kStepParts + kDemands + 3, "");
      row.push_back(f.why);
    }
    out += line_of(row);
  }
  return out;
}

std::string machine_report(const MachineStudy& study, const MachineFinding& f) {
  std::string out;
  const auto row = [&](const std::string& name, const std::string& value, const std::string& note) {
    out += fmt::format("  {:<16} {}{}\n", name, value, note.empty() ? "" : ", " + note);
  };
  const std::vector<std::string> names = measure_names(study.figure_names());
  for (size_t m = 0; m < f.values.size(); ++m) {
    const MachineValue& value = f.values[m];
    if (!value.there()) continue;
    std::string note = to_string(value.known);
    if (quantity_at(m) == MachineQuantity::cycles)
      note += fmt::format(", the mean of {} steps; the most {}", f.counts->steps, f.counts->most);
    row(names[m], value_text(quantity_at(m), value), note);
  }
  std::string lacking;
  for (const std::string& name : f.lacking) lacking += (lacking.empty() ? "" : ", ") + name;
  if (!lacking.empty()) row("missing", "no figure of " + lacking, "");
  row("bound by", bound_of(*f.counts), "");
  return out;
}

std::string constraints_report(const MachineStudy& study, const MachineFinding& f) {
  std::string out;
  for (size_t k = 0; k < study.constraints.size(); ++k) {
    const MachineConstraint& c = study.constraints[k];
    const MachineValue& value = f.kept[k];
    std::string text = c.target.empty() ? value_text(quantity_at(c.measure), value) : "not known";
    if (!c.target.empty() && value.there())
      text = fmt::format("{:.3g} to {:.3g} of its room", value.band.low, value.band.high);
    out += fmt::format("  {:<24} {:<10} {}{}\n", line_text(c.text), to_string(judge(c, value)), text,
                       value.there() ? std::string(", ") + to_string(value.known) : "");
  }
  return out;
}

std::string machines_lines(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                           const std::vector<size_t>& some) {
  std::string out = fmt::format("  {:>4} {:>9} {:>10} {:>22} {:>20} {:>20}  {:<8} {}\n", "", "cycles",
                                "steps/s", "energy", "power", "area", "bound by", "machine");
  for (const size_t n : some) {
    const MachineFinding& f = findings[n];
    const auto text = [&](MachineQuantity q) { return value_text(q, f.value(q)); };
    out += fmt::format(
        "  {:>4} {:>9} {:>10} {:>22} {:>20} {:>20}  {:<8} {}\n", n + 1, text(MachineQuantity::cycles),
        text(MachineQuantity::rate), text(MachineQuantity::energy), text(MachineQuantity::power),
        text(MachineQuantity::area), bound_of(*f.counts), line_text(machine_text(study, f.choice)));
  }
  return out;
}

std::string machine_json(const MachineStudy& study, const MachineFinding& f) {
  const std::vector<std::string> names = measure_names(study.figure_names());
  std::string values = "{";
  for (size_t m = 0; m < f.values.size(); ++m)
    if (f.values[m].there())
      values += fmt::format("{}{}:{}", values.size() > 1 ? "," : "", json(names[m]),
                            json_object({{"low", json(f.values[m].band.low)},
                                         {"high", f.values[m].open ? "null" : json(f.values[m].band.high)},
                                         {"known", json(std::string(to_string(f.values[m].known)))}}));
  values += "}";
  std::vector<std::string> constraints;
  for (size_t k = 0; k < study.constraints.size(); ++k)
    constraints.push_back(
        json_object({{"text", json(study.constraints[k].text)},
                     {"verdict", json(std::string(to_string(judge(study.constraints[k], f.kept[k]))))},
                     {"low", json(f.kept[k].band.low)},
                     {"high", f.kept[k].open ? "null" : json(f.kept[k].band.high)}}));
  return json_object({{"machine", json(machine_text(study, f.choice))},
                      {"values", values},
                      {"steps", f.counts ? std::to_string(f.counts->steps) : "0"},
                      {"counted_cycles", f.counts ? std::to_string(f.counts->cycles) : "null"},
                      {"bound_by", f.counts ? json(bound_of(*f.counts)) : "null"},
                      {"lacking", json(f.lacking)},
                      {"constraints", json_array(constraints)}});
}

}  // namespace cuboct::study
