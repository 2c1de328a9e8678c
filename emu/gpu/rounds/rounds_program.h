// SPDX-License-Identifier: MIT
// The operations of a program in a device's memory.
#pragma once

#include <algorithm>
#include <cstring>

#include "emu/gpu/device/device.h"
#include "emu/gpu/rounds/rounds_code.h"
#include "emu/gpu/rounds/rounds_text.h"

namespace cuboct::gpu {

struct CodeTable {
  int shape, difference_frac, index_bits, bin_bits, first_octave, fraction_bits;
  uint32_t last;  // entry
  bool flat;      // no slope takes more than 32 bits
  const TableEntry* entries;
};

template <typename T>
struct Span {
  const T* data = nullptr;
  int count = 0;
};

// Elements of an image of 16 bytes a line.
template <typename T>
struct Part {
  uint32_t line = 0, count = 0;
};
struct alignas(16) Line {
  uint8_t bytes[16];
};

// RoundLists on a device. What its threads read again and again is an image that a block copies.
struct RoundCode {
  Span<Line> image;
  Span<Constant> constants, finish_constants;
  Part<Operation> prepare, early, late, finish;
  Fetch apart[3];
  Part<Fetch> own, early_fetch, late_fetch, finish_fetch;
  Part<Store> terms, writes, v, u, drift;
  const CodeTable *tables, *finish_tables;
  int types, when, registers;
  Part<Store> bond_writes;
  Span<Constant> broken_constants;
  Part<Operation> broken_code;
  Part<Fetch> broken_fetch;
  const CodeTable* broken_tables;
  int broken, broken_registers;

  // Of a thread, and of a block beside its threads'.
  size_t thread_bytes() const {
    return static_cast<size_t>(registers + broken_registers) * kTogether * sizeof(int32_t) +
           terms.count * sizeof(int64_t);
  }
  size_t bytes(size_t threads) const {
    return threads * thread_bytes() + static_cast<size_t>(image.count) * sizeof(Line);
  }
};

// Holds what RoundCodes point to.
class ProgramOnDevice {
 public:
  // InputError as of code_of.
  ProgramOnDevice(Stream& stream, const graph::FixedProgram& program) : stream_(stream) {
    const std::vector<RoundLists> lists = code_of(program);
    type_constants_ = put_constants(program.type_constants);
    pair_constants_ = put_constants(program.pair_constants);
    for (size_t k = 0; k < lists.size(); ++k) {
      const RoundLists& of = lists[k];
      std::vector<Line> image;
      RoundCode code{};
      code.prepare = add(of.prepare, image), code.early = add(of.early, image),
      code.late = add(of.late, image);
      code.finish = add(of.finish, image), code.broken_code = add(of.broken_code, image);
      code.own = add(of.own, image), code.early_fetch = add(of.early_fetch, image);
      code.late_fetch = add(of.late_fetch, image), code.finish_fetch = add(of.finish_fetch, image);
      code.broken_fetch = add(of.broken_fetch, image);
      code.terms = add(of.terms, image), code.writes = add(of.writes, image);
      code.v = add(of.v, image), code.u = add(of.u, image), code.drift = add(of.drift, image);
      code.bond_writes = add(of.bond_writes, image);
      image.emplace_back();  // a thread loads an operation while it runs the one before
      code.image = put(image, images_);
      code.constants = put(of.constants, numbers_);
      code.finish_constants = put(of.finish_constants, numbers_);
      code.broken_constants = put(of.broken_constants, numbers_);
      code.tables = put_tables(program.rounds[k].pair);
      code.finish_tables = put_tables(program.rounds[k].finish);
      code.broken_tables = put_tables(program.broken);
      std::copy(of.apart.begin(), of.apart.end(), code.apart);
      code.types = program.types;
      code.when = of.when, code.registers = of.registers;
      code.broken = of.broken, code.broken_registers = of.broken_registers;
      rounds_.push_back(code);
    }
  }
  const std::vector<RoundCode>& rounds() const { return rounds_; }
  // [constant][type], [constant][own type][other type]
  const int64_t* type_constants() const { return type_constants_; }
  const int64_t* pair_constants() const { return pair_constants_; }

 private:
  template <typename T>
  Span<T> put(const std::vector<T>& values, std::vector<Array<T>>& into) {
    into.emplace_back(stream_.device());
    into.back().set(stream_, values);
    return {into.back().data(), static_cast<int>(values.size())};
  }
  template <typename T>
  static Part<T> add(const std::vector<T>& values, std::vector<Line>& image) {
    const Part<T> part{static_cast<uint32_t>(image.size()), static_cast<uint32_t>(values.size())};
    image.resize(image.size() + (values.size() * sizeof(T) + sizeof(Line) - 1) / sizeof(Line));
    if (!values.empty()) std::memcpy(&image[part.line], values.data(), values.size() * sizeof(T));
    return part;
  }
  const int64_t* put_constants(const std::vector<graph::Constants>& constants) {
    std::vector<int64_t> values;
    for (const graph::Constants& one : constants)
      values.insert(values.end(), one.values.begin(), one.values.end());
    return put(values, constants_).data;
  }
  const CodeTable* put_tables(const graph::Graph& graph) {
    std::vector<CodeTable> tables;
    for (const FixedTable& table : graph.tables) {
      const Span<TableEntry> entries = put(entries_of(table), entries_);
      tables.push_back({static_cast<int>(table.shape), table.difference_frac, table.index_bits,
                        table.bin_bits, table.first_octave, table.fraction_bits,
                        static_cast<uint32_t>(entries.count - 1), is_flat(table), entries.data});
    }
    return put(tables, tables_).data;
  }

  Stream& stream_;
  std::vector<Array<Line>> images_;
  std::vector<Array<Constant>> numbers_;
  std::vector<Array<CodeTable>> tables_;
  std::vector<Array<TableEntry>> entries_;
  std::vector<Array<int64_t>> constants_;
  const int64_t *type_constants_ = nullptr, *pair_constants_ = nullptr;
  std::vector<RoundCode> rounds_;
};

}  // namespace cuboct::gpu
