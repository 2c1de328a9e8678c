// SPDX-License-Identifier: MIT
#include "cli/machine/energy_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/json.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct Prefix {
  double scale;
  const char* text;
};

Prefix prefix_of(double value) {
  static constexpr Prefix kAll[] = {{1e9, "G"},  {1e6, "M"},  {1e3, "k"},   {1, ""},     {1e-3, "m"},
                                    {1e-6, "u"}, {1e-9, "n"}, {1e-12, "p"}, {1e-15, "f"}};
  for (const Prefix& p : kAll)
    if (value >= p.scale) return p;
  return value > 0 ? kAll[8] : kAll[3];
}

// An empty sum is one of which nothing is known.
std::string known(const Energy& energy, const Band& band, const std::string& unit) {
  return energy.rows.empty() ? "not known: every term is missing" : band_text(band, unit);
}

std::string events_text(const EnergyMachine& m) {
  std::string out =
      fmt::format("\nevents of {}, {} steps, {} cycles\n", line_text(m.arch), m.steps, m.cycles);
  for (const auto& [name, count] : event_names())
    if (m.events.*count > 0) out += fmt::format("  {:<14} {:>14}\n", name, m.events.*count);
  if (m.traffic.empty()) return out;
  out += fmt::format("memories of {}                       words x bits        reads       writes\n",
                     line_text(m.arch));
  for (const MemoryTraffic& t : m.traffic)
    out += fmt::format("  {:<38} {:>6} x {:<4} {:>12} {:>12}\n", t.holds, t.words, t.bits, t.reads, t.writes);
  return out;
}

// Terms of the same name, of several memories or tables, as one.
std::vector<EnergyRow> merged(const std::vector<EnergyRow>& rows) {
  std::vector<EnergyRow> out;
  for (const EnergyRow& row : rows) {
    const auto found = std::ranges::find(out, row.term, &EnergyRow::term);
    if (found == out.end()) {
      out.push_back(row);
      continue;
    }
    found->events += row.events;
    found->picojoules += row.picojoules;
  }
  return out;
}

std::string finding_text(const EnergyFindings& all, const EnergyMachine& m, const EnergyFinding& f) {
  std::string out =
      fmt::format("\n{} in {}: {}\n", line_text(m.arch), line_text(f.technology), line_text(f.title));
  for (const EnergyRow& row : merged(f.energy.rows))
    out += fmt::format("  {:<46} {:>26}\n", row.term,
                       band_text(1e-12 / static_cast<double>(m.updates) * row.picojoules, "J"));
  out += fmt::format("  {:<46} {:>26}\n", "energy per particle-step",
                     known(f.energy, m.joules_per_update(f.energy), "J"));
  out += fmt::format("  {:<46} {:>26}\n", fmt::format("power at {:g} MHz", all.clock / 1e6),
                     known(f.energy, m.watts(f.energy, all.clock), "W"));
  for (const AreaRow& row : f.area.rows)
    out += fmt::format("  area: {:<40} {:>26}\n", row.part, band_text(row.mm2, "mm^2"));
  if (!f.area.rows.empty())
    out += fmt::format("  {:<46} {:>26}\n", "area, without what is missing", band_text(f.area.sum, "mm^2"));
  constexpr size_t kBars = 5;
  if (!f.bars.empty()) out += "  the sum moves most with, others in the middle\n";
  for (size_t k = 0; k < std::min(kBars, f.bars.size()); ++k)
    out += fmt::format(
        "    {:<44} {:>26}\n", name_of(f.bars[k].constant),
        band_text(1e-12 / static_cast<double>(m.updates) * Band{f.bars[k].low, f.bars[k].high}, "J"));
  for (const std::string& missing : f.energy.missing)
    out += fmt::format("  missing: {}\n", line_text(missing));
  for (const std::string& missing : f.area.missing)
    out += fmt::format("  missing of area: {}\n", line_text(missing));
  return out;
}

// Names of the terms that a sum lacks, without why.
std::vector<std::string> lacks(const Energy& energy) {
  std::vector<std::string> terms;
  for (const std::string& text : energy.missing) terms.push_back(text.substr(0, text.find(": no '")));
  return terms;
}

// Two technologies of one machine, two machines in one technology.
struct Pair {
  std::string first, second, order;
};
std::vector<Pair> pairs_of(const EnergyFindings& found) {
  std::vector<Pair> pairs;
  const auto add = [&](const EnergyMachine& m, const EnergyFinding& f, const EnergyMachine& n,
                       const EnergyFinding& g) {
    if (f.energy.rows.empty() || g.energy.rows.empty()) return;
    pairs.push_back({m.arch + " in " + f.technology, n.arch + " in " + g.technology,
                     lacks(f.energy) == lacks(g.energy)
                         ? order_of(m.joules_per_update(f.energy), n.joules_per_update(g.energy))
                         : "not the same terms: no order"});
  };
  for (const EnergyMachine& m : found.machines)
    for (size_t i = 0; i < m.findings.size(); ++i)
      for (size_t j = i + 1; j < m.findings.size(); ++j) add(m, m.findings[i], m, m.findings[j]);
  for (size_t i = 1; i < found.machines.size(); ++i)
    for (size_t t = 0; t < found.machines[i].findings.size(); ++t)
      add(found.machines[0], found.machines[0].findings[t], found.machines[i], found.machines[i].findings[t]);
  return pairs;
}

std::string json_band(const Band& band) { return json(std::vector<double>{band.low, band.high}); }

std::string json_finding(const EnergyFindings& all, const EnergyMachine& m, const EnergyFinding& f) {
  const bool nothing = f.energy.rows.empty();
  const auto or_null = [&](const Band& band) { return nothing ? std::string("null") : json_band(band); };
  return json_object({{"technology", json(f.technology)},
                      {"terms", json_array(f.energy.rows,
                                           [](const EnergyRow& r) {
                                             return json_object({{"term", json(r.term)},
                                                                 {"events", json(r.events)},
                                                                 {"of", json(r.of)},
                                                                 {"picojoules", json_band(r.picojoules)},
                                                                 {"source", json(r.source)}});
                                           })},
                      {"picojoules", or_null(f.energy.sum)},
                      {"joules_per_particle_step", or_null(m.joules_per_update(f.energy))},
                      {"watts", or_null(m.watts(f.energy, all.clock))},
                      {"area", json_array(f.area.rows,
                                          [](const AreaRow& r) {
                                            return json_object({{"part", json(r.part)},
                                                                {"mm2", json_band(r.mm2)},
                                                                {"source", json(r.source)}});
                                          })},
                      {"area_mm2", f.area.rows.empty() ? "null" : json_band(f.area.sum)},
                      {"sensitivity", json_array(f.bars,
                                                 [](const Sensitivity& s) {
                                                   return json_object(
                                                       {{"constant", json(std::string(name_of(s.constant)))},
                                                        {"picojoules", json_band({s.low, s.high})}});
                                                 })},
                      {"missing", json(f.energy.missing)},
                      {"missing_area", json(f.area.missing)}});
}

std::string json_machine(const EnergyFindings& all, const EnergyMachine& m) {
  std::vector<std::string> events;
  for (const auto& [name, count] : event_names())
    events.push_back(json(std::string(name)) + ":" + std::to_string(m.events.*count));
  return json_object({{"arch", json(m.arch)},
                      {"nodes", std::to_string(m.nodes)},
                      {"steps", std::to_string(m.steps)},
                      {"cycles", std::to_string(m.cycles)},
                      {"events", fmt::format("{{{}}}", fmt::join(events, ","))},
                      {"memories", json_array(m.traffic,
                                              [](const MemoryTraffic& t) {
                                                return json_object({{"holds", json(t.holds)},
                                                                    {"words", std::to_string(t.words)},
                                                                    {"bits", std::to_string(t.bits)},
                                                                    {"copies", std::to_string(t.copies)},
                                                                    {"reads", std::to_string(t.reads)},
                                                                    {"writes", std::to_string(t.writes)}});
                                              })},
                      {"technologies", json_array(m.findings, [&](const EnergyFinding& f) {
                         return json_finding(all, m, f);
                       })}});
}

}  // namespace

Band EnergyMachine::joules_per_update(const Energy& energy) const {
  return 1e-12 / static_cast<double>(updates) * energy.sum;
}

Band EnergyMachine::watts(const Energy& energy, double clock) const {
  return 1e-12 * clock / static_cast<double>(cycles) * energy.sum;
}

std::string band_text(const Band& band, const std::string& unit) {
  // Prefixes of a square are squared.
  const Prefix p = unit.ends_with("^2") ? Prefix{1, ""} : prefix_of(band.high);
  return fmt::format("{:.3g} to {:.3g} {}{}", band.low / p.scale, band.high / p.scale, p.text, unit);
}

std::string order_of(const Band& first, const Band& second) {
  if (overlap(first, second)) return "within the band: no order";
  return first.high < second.low ? "the first takes less" : "the second takes less";
}

std::string text_of(const EnergyFindings& found) {
  std::string out = fmt::format("scene  {}\nclock  {:g} MHz\nlinks  {}\n", line_text(found.scene),
                                found.clock / 1e6, found.link.empty() ? "wires on chip" : found.link);
  for (const EnergyMachine& m : found.machines) {
    out += events_text(m);
    for (const EnergyFinding& f : m.findings) out += finding_text(found, m, f);
  }
  const std::vector<Pair> pairs = pairs_of(found);
  if (!pairs.empty()) out += "\nenergy per particle-step, two by two\n";
  for (const Pair& p : pairs)
    out += fmt::format("  {}, {}: {}\n", line_text(p.first), line_text(p.second), p.order);
  return out;
}

std::string json_of(const EnergyFindings& found) {
  return json_object(
             {{"scene", json(found.scene)},
              {"clock", json(found.clock)},
              {"link", found.link.empty() ? "null" : json(found.link)},
              {"machines",
               json_array(found.machines, [&](const EnergyMachine& m) { return json_machine(found, m); })},
              {"comparisons", json_array(pairs_of(found),
                                         [](const Pair& p) {
                                           return json_object({{"first", json(p.first)},
                                                               {"second", json(p.second)},
                                                               {"order", json(p.order)}});
                                         })}}) +
         "\n";
}

}  // namespace cuboct
