// SPDX-License-Identifier: MIT
// The C interface of a compiled RTL library. Included by the shim, which is compiled with the Verilated
// model, and by the engine that loads it. Words are little endian; beats have 512 bits, particles 2048.
#ifndef CUBOCT_VERILATED_ABI_H
#define CUBOCT_VERILATED_ABI_H

#include <cstdint>

enum { kCuboctAbi = 10, kCuboctFaces = 6, kCuboctWords = 8, kCuboctParticleWords = 32 };

// Inputs of one node during one cycle. `link_data[f]` is read where bit f of `link_valid` is set.
struct CuboctIn {
  uint8_t reset_n, start, load_valid, has_link, link_valid, link_ready, link_end;
  uint32_t steps, load_cell;  // load_cell: of a brick
  const uint64_t* load_data;
  const uint64_t* link_data[kCuboctFaces];
  uint16_t link_ack[kCuboctFaces];  // where links are checked
};

// Outputs of one node: `link_*` after the edge that ends the cycle, the others of the cycle.
struct CuboctOut {
  uint32_t phase_start, phase_end;
  uint8_t observe_valid, fault_valid, fault_code, fault_stage,
      idle;  // fault_stage: of a rule of text, else 0
  uint8_t link_valid, link_end, link_ready;
  uint8_t force_event;              // of a node alone: engine runs; by streamer: stalled, presents, issues
  uint8_t pairs;                    // of a node alone: pipes that take a pair
  uint8_t beat_errors, ack_errors;  // of the cycle; these and link_ack where links are checked
  uint8_t still;  // of a node alone: with the same inputs no clock would change a bit of it, nor show more
                  // than force_event
  uint16_t link_ack[kCuboctFaces];
  uint32_t fault_id, observe_cell, fault_cell;  // the cells of a brick
  int64_t fault_number;
  uint64_t observe_data[kCuboctParticleWords];     // where observe_valid
  uint64_t link_data[kCuboctFaces][kCuboctWords];  // where link_valid
};

// A library gives these symbols:
//   int cuboct_abi(void);                      kCuboctAbi
//   void* cuboct_create(uint32_t seed);        0: registers start as zeros; else as random bits
//   void cuboct_destroy(void* model);
// and, of a node,
//   const char* cuboct_clock(void* model, const CuboctIn*, CuboctOut*);
//   void cuboct_place(void* model, const uint64_t* extent, const uint64_t* exits);   of a brick: before the
//   first clock
// or, of a whole lattice, whose host loads one particle of node `load_node` per cycle; `out` has an element
// per node
//   const char* cuboct_clock_lattice(void* model, const CuboctIn* host, uint32_t load_node, CuboctOut* out);
// or, of the top of a board, `cycles` long: the levels of the line to it and from it, and whether the lamp
// that says idle is lit in the end
//   const char* cuboct_clock_board(void* model, const uint8_t* rx, uint8_t* tx, int cycles, uint8_t* idle);
// or, of the wrapper of a bus, whose bus master writes the first of `rx_count` bytes, reads up to `tx_room`,
// for about so many cycles, and tells how many it did, and whether no run was under way
//   const char* cuboct_clock_bus(void* model, const uint8_t* rx, int rx_count, int* rx_taken, uint8_t* tx,
//                                int tx_room, int* tx_count, int cycles, uint8_t* idle);
// They return null, or "file:line" of the first assertion of the RTL that failed: then the model is of no
// further use but to be destroyed.

#endif
