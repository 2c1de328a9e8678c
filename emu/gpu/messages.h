// SPDX-License-Identifier: MIT
// What the engine says where it refuses. Apart from the kernels: no GPU compiler sees how numbers are
// printed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emu/gpu/engine.h"
#include "model/rules/lps.h"

namespace cuboct::gpu {

// InputError.
[[noreturn]] void throw_too_many(uint64_t particles, uint64_t most);
// InputError: of a scene with so many planes of cells along its longest axis.
[[noreturn]] void throw_few_planes(int slabs, int planes);
[[noreturn]] void throw_far_particle(size_t particle);
// std::runtime_error: a particle with so many others around.
[[noreturn]] void throw_too_dense(uint64_t others);
// InputError: a rule of text in "float"s or "double"s, and why there is no code of it.
[[noreturn]] void throw_not_compiled(const char* numbers, const std::string& why);
// Of a step in which a table is asked for more than it has.
std::string table_ends_text(uint64_t step);
// InputError where an ordinal is not there, or a block is no multiple of 32 up to 256.
void require_devices(const Options& options);
// InputError where a rule's positions are wider than the fixed engine's numbers.
void require_widths(const Widths& widths);
// InputError where the devices cannot hold a scene: `cells` bytes/4 of tables on each.
void require_memory(const Options& options, uint64_t particles, uint64_t cells, double bytes_per_particle);
// InputError where a block of a device cannot hold a rule's tables.
void require_tables(const Options& options, uint64_t bytes);
// InputError where there is none of this ordinal.
Device device_at(int ordinal);
// InputError: a sample's cell (emu/gpu/samples/samples.h) is too thin, angstrom.
[[noreturn]] void throw_thin_cell(size_t sample, double thickness, double reach);
// ElementError: the sample of an element (emu/gpu/samples/sample_relaxer.h) has become so.
[[noreturn]] void throw_crushed_element(size_t element, double thickness, double reach);
// InputError where the memory of a device's block cannot hold a sample of so many bytes.
void require_sample(int device, uint64_t atoms, uint64_t bonds, uint64_t bytes);
// std::runtime_error
[[noreturn]] void throw_lost_sample(size_t sample);
// InputError where a scene has what the peridynamic solid of emu/gpu/lps/lps.h has not, or does not fit.
void require_lps(const Rule& rule, const LpsMaterial& material);
void require_lps_memory(int device, uint64_t particles, uint64_t bytes);
// std::runtime_error: some step up to this one lost it.
[[noreturn]] void throw_lost_point(uint64_t step, uint32_t particle);
// std::runtime_error: in the step after `step`.
[[noreturn]] void throw_not_finite(uint64_t step, uint32_t fastest, double speed);

}  // namespace cuboct::gpu
