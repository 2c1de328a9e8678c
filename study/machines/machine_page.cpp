// SPDX-License-Identifier: MIT
#include "study/machines/machine_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "model/base/filled_frame.h"
#include "model/base/json.h"
#include "model/base/text.h"
#include "study/machines/machine_table.h"
#include "study/report/chart_json.h"
#include "study/report/web.h"

namespace cuboct::study {
namespace {

// A cell of the table as a number, where it is one.
std::string cell_json(const std::string& cell) {
  double number = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return error == std::errc() && end == cell.data() + cell.size() ? json(number) : json(cell);
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts{""};
  for (const char c : text)
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

std::string peer_json(const Peer& peer) {
  return json_object({{"what", json(peer.what)},
                      {"known", json(peer.known)},
                      {"particles", json(peer.particles)},
                      {"rate", json(peer.rate)},
                      {"joules", json(std::vector{peer.joules.low, peer.joules.high})},
                      {"source", json(peer.source)}});
}

std::string summary_of(const MachineResults& r) {
  const auto refused = std::ranges::count_if(r.findings, [](const MachineFinding& f) { return !f.done(); });
  std::string text =
      fmt::format("{} machines, {} refused; cycles are means of {} counted steps. Scene: ", r.findings.size(),
                  refused, r.study.steps);
  for (const Base& base : r.study.scenes) text += (&base == &r.study.scenes[0] ? "" : ", ") + base.scene_path;
  return text;
}

}  // namespace

std::string machine_page_of(const MachineResults& r) {
  std::vector<std::string> lines = split(machines_tsv(r.study, r.findings, r.front), '\n');
  lines.pop_back();
  std::vector<std::string> rows, columns, constraints;
  for (size_t k = 1; k < lines.size(); ++k) rows.push_back(json_array(split(lines[k], '\t'), cell_json));
  for (const MachineConstraint& c : r.study.constraints) constraints.push_back(c.text);
  const std::string charts = charts_json(machine_charts(r), columns);
  const std::string data = json_object({{"summary", json(summary_of(r))},
                                        {"constraints", json(constraints)},
                                        {"head", json(split(lines[0], '\t'))},
                                        {"rows", json_array(rows)},
                                        {"peers", json_array(r.peers, peer_json)},
                                        {"series", "[]"},
                                        {"charts", charts},
                                        {"columns", json_array(columns)}});
  const std::string title =
      html_text(r.study.frame.title.empty() ? "A study of machines" : r.study.frame.title);
  return filled_frame(web_machines_frame(), {{"@title@", title},
                                             {"@style@", std::string(web_style())},
                                             {"@title@", title},
                                             {"@licences@", html_text(std::string(web_licences()))},
                                             {"@data@", data},
                                             {"@library@", std::string(web_library())},
                                             {"@script@", std::string(web_machines_script())}});
}

}  // namespace cuboct::study
