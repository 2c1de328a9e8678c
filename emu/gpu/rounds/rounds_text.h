// SPDX-License-Identifier: MIT
// A program as C++: for each of its rounds the Graphs of RoundsStep (rounds_kernel.h) and a kernel, for a
// compiler that the engine calls (nvrtc.h). Statements are those of model/graph/emit_integers.h.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "emu/gpu/rounds/rounds_table.h"
#include "model/graph/program.h"

namespace cuboct::gpu {

struct RoundsText {
  std::string source;               // includes files of round_headers()
  std::vector<std::string> names;   // of the kernels, by round
  std::vector<TableEntry> entries;  // RoundsFrame::entries: of all tables, one after the other
};
// `frame_bytes`: of the RoundsFrame that the engine passes; the compiler checks that it is the kernel's.
RoundsText text_of(const graph::FixedProgram& program, size_t frame_bytes);

// Whether no slope that a lookup meets, before a fraction scales it, takes more than 32 bits.
bool is_flat(const FixedTable& table);
// A line's c2 is 0.
std::vector<TableEntry> entries_of(const FixedTable& table);

// Name and text of what the source includes.
const std::vector<std::pair<std::string, std::string>>& round_headers();

}  // namespace cuboct::gpu
