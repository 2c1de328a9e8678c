// SPDX-License-Identifier: MIT
#include "emu/gpu/start.h"

#include <fmt/format.h>

#include "model/base/error.h"
#include "model/trace/guarded_trace.h"

namespace cuboct::gpu {

void start_from(const std::string& path, Scene& scene) {
  Trace trace = guarded_trace(path);
  if (trace.bodies.empty())
    throw InputError(fmt::format("--start {}: this trace holds no state in real numbers", path));
  RealFrame& frame = trace.bodies.back();
  if (frame.x.size() != scene.body.size())
    throw InputError(fmt::format("--start {}: a state of {} particles, the scene has {}", path,
                                 frame.x.size(), scene.body.size()));
  scene.body.x = std::move(frame.x);
  scene.body.v = std::move(frame.v);
  scene.body.exact.reset();
}

}  // namespace cuboct::gpu
