// SPDX-License-Identifier: MIT
// A run on a board: loads, runs, reads, and finds the step and the particle of a fault.
#pragma once

#include "emu/board/host.h"
#include "hw/engine/engine_kind.h"

namespace cuboct::emu {

// References are kept. Making the engine throws InputError where the board holds another machine than `plan`,
// or the lattice cannot hold the scene; its calls throw std::runtime_error where the line or the board fails.
// The board stops and is read out wherever a state or its hash is asked for.
// Counters of the trace: cycles, requests, retries, bytes on the line.
EngineKind board_kind(Host& host, const Scene& scene, const Plan& plan);

}  // namespace cuboct::emu
