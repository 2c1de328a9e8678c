// SPDX-License-Identifier: MIT
// What a pair's graph makes of d alone.
#pragma once

#include <array>

#include "model/program/real_graph.h"

namespace cuboct {

// Depends on r alone, or on nothing.
bool is_radial(const RealGraph& graph, NodeId id);
// x, y and z of a vector that is d times what is_radial().
bool is_along(const RealGraph& graph, const std::array<NodeId, 3>& vector);

}  // namespace cuboct
