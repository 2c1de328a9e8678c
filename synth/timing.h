// SPDX-License-Identifier: MIT
// What timing tools say, read from their reports.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace cuboct::synth {

struct Use {
  uint64_t used = 0, available = 0;
};

// nextpnr's JSON report (--report).
struct Placed {
  double fmax = 0;                 // MHz, of the slowest clock
  std::map<std::string, Use> use;  // by kind of cell: "ICESTORM_LC", "TRELLIS_COMB", ...
  std::vector<std::string>
      critical;  // "0.54 ns logic NET" parts of the critical path, as source and sink names
};
// Throws InputError: no such file, no JSON, no report of nextpnr (no clock was found).
Placed read_nextpnr_report(const std::string& file);

// "Info: \t ICESTORM_LC: 900/ 5280 17%" lines, which nextpnr prints before it places: where placing failed
// there is no report.
std::map<std::string, Use> read_utilisation(const std::string& log);

// MHz of icetime's "Total path delay: 19.68 ns (50.81 MHz)".
std::optional<double> read_icetime(const std::string& log);

// OpenSTA's "slack" of the longest path, ns, and "Total" power, W; nothing where it did not get so far.
struct Analysed {
  double slack = 0, power = 0;
};
std::optional<Analysed> read_sta(const std::string& log);

// Length of the longest path of yosys's `ltp -noff`: cells between registers.
std::optional<uint64_t> read_depth(const std::string& log);

}  // namespace cuboct::synth
