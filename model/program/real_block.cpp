// SPDX-License-Identifier: MIT
#include "model/program/real_block.h"

#include <algorithm>
#include <array>
#include <utility>

namespace cuboct {
namespace {

constexpr size_t kLeastLanes = 64;

using Loop = void (*)(size_t count, double* to, const double* a, const double* b, const double* c);

template <RealOp op>
void loop(size_t count, double* to, const double* a, const double* b, const double* c) {
  for (size_t k = 0; k < count; ++k) to[k] = applied(op, a[k], b[k], c[k]);
}

// One loop for each operation, which is known where it is compiled.
template <size_t... op>
constexpr std::array<Loop, sizeof...(op)> loops(std::index_sequence<op...>) {
  return {loop<static_cast<RealOp>(op)>...};
}
constexpr auto kLoops = loops(std::make_index_sequence<static_cast<size_t>(RealOp::select) + 1>());

}  // namespace

void RealBlock::reserve(size_t count) {
  if (count <= lanes_ && !values_.empty()) return;
  lanes_ = std::max({kLeastLanes, count, 2 * lanes_});
  values_.assign(lanes_ * graph_.nodes().size() + 1, 0);
  for (NodeId id = 0; id < graph_.nodes().size(); ++id)
    if (graph_.at(id).op == RealOp::constant) std::fill_n(lanes_of(id), lanes_, graph_.at(id).value);
}

void apply(const RealNode& node, size_t count, double* to, const double* a, const double* b,
           const double* c) {
  if (!is_curve(node.op)) return kLoops[static_cast<size_t>(node.op)](count, to, a, b, c);
  for (size_t k = 0; k < count; ++k) to[k] = applied(node, a[k], 0, 0);
}

}  // namespace cuboct
