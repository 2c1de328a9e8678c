// SPDX-License-Identifier: MIT
// The operations of a program in a device's memory.
#pragma once

#include "emu/gpu/device/device.h"
#include "emu/gpu/rounds/rounds_code.h"

namespace cuboct::gpu {

struct CodeTable {
  int shape, degree, difference_frac, index_bits, bin_bits, first_octave, fraction_bits;
  const int32_t *c0, *c1, *c2;
};

template <typename T>
struct Span {
  const T* data = nullptr;
  int count = 0;
};

// RoundLists on a device.
struct RoundCode {
  Span<Operation> constants, early, late, finish_constants, finish;
  Span<Fetch> own, early_fetch, late_fetch, finish_fetch;
  Span<Store> terms, writes, v, u, drift;
  const CodeTable *tables, *finish_tables;
  int types, when, registers;
  Span<Store> bond_writes;
  Span<Operation> broken_constants, broken_code;
  Span<Fetch> broken_fetch;
  const CodeTable* broken_tables;
  int broken, broken_registers;

  // Registers and sums of a thread.
  size_t numbers() const { return static_cast<size_t>(registers + terms.count + broken_registers); }
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
      rounds_.push_back({put(of.constants, operations_),
                         put(of.early, operations_),
                         put(of.late, operations_),
                         put(of.finish_constants, operations_),
                         put(of.finish, operations_),
                         put(of.own, fetches_),
                         put(of.early_fetch, fetches_),
                         put(of.late_fetch, fetches_),
                         put(of.finish_fetch, fetches_),
                         put(of.terms, stores_),
                         put(of.writes, stores_),
                         put(of.v, stores_),
                         put(of.u, stores_),
                         put(of.drift, stores_),
                         put_tables(program.rounds[k].pair),
                         put_tables(program.rounds[k].finish),
                         program.types,
                         of.when,
                         of.registers,
                         put(of.bond_writes, stores_),
                         put(of.broken_constants, operations_),
                         put(of.broken_code, operations_),
                         put(of.broken_fetch, fetches_),
                         put_tables(program.broken),
                         of.broken,
                         of.broken_registers});
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
  const int64_t* put_constants(const std::vector<graph::Constants>& constants) {
    std::vector<int64_t> values;
    for (const graph::Constants& one : constants)
      values.insert(values.end(), one.values.begin(), one.values.end());
    return put(values, constants_).data;
  }
  const CodeTable* put_tables(const graph::Graph& graph) {
    std::vector<CodeTable> tables;
    for (const FixedTable& table : graph.tables)
      tables.push_back({static_cast<int>(table.shape), table.degree, table.difference_frac, table.index_bits,
                        table.bin_bits, table.first_octave, table.fraction_bits, put(table.c0, entries_).data,
                        put(table.c1, entries_).data, put(table.c2, entries_).data});
    return put(tables, tables_).data;
  }

  Stream& stream_;
  std::vector<Array<Operation>> operations_;
  std::vector<Array<Fetch>> fetches_;
  std::vector<Array<Store>> stores_;
  std::vector<Array<CodeTable>> tables_;
  std::vector<Array<int32_t>> entries_;
  std::vector<Array<int64_t>> constants_;
  const int64_t *type_constants_ = nullptr, *pair_constants_ = nullptr;
  std::vector<RoundCode> rounds_;
};

}  // namespace cuboct::gpu
