// SPDX-License-Identifier: MIT
// What a benchmark found: lines of a table for people, lines of JSON and of "name value unit" for scripts. No
// dates: what does not depend on the machine's speed is the same each time.
#pragma once

#include <string>
#include <vector>

#include "emu/gpu/bench/bench.h"

namespace cuboct::gpu {

struct BenchSetting {
  std::vector<Device> devices;  // those of the slabs, each once
  std::string driver;           // empty if not known
  std::string no_energy;        // why no row will have one; empty if it may
  double bandwidth = 0;         // B/s, of copies on all devices together
  BenchOptions options;
};

// Comment lines ("# ...") with the setting, and the table's head.
std::string table_head(const BenchSetting& setting);
std::string table_line(const BenchSetting& setting, const BenchRow& row, const RowResult& result);

// One line each: {"devices":[...],...}; {"row":"block_256k.float",...}; {"row":"...","left_out":"..."}.
std::string json_line(const BenchSetting& setting);
std::string json_line(const BenchSetting& setting, const BenchRow& row, const RowResult& result);
std::string json_left_out(const BenchRow& row, const std::string& why);

// For `cuboct bench`: a comment that tells how it was measured, then "particle_steps R 1/s" and "repeat S s".
std::string value_lines(const BenchSetting& setting, const RowResult& result);

}  // namespace cuboct::gpu
