// SPDX-License-Identifier: MIT
#include "model/trace/finding.h"

namespace cuboct {

const char* to_string(Failure failure) {
  switch (failure) {
    case Failure::time_step:
      return "time step";
    case Failure::damping:
      return "damping";
    case Failure::stiff_hold:
      return "stiff hold";
    case Failure::force_jump:
      return "force jump";
    case Failure::tunnelling:
      return "tunnelling";
    case Failure::constraint_work:
      return "constraint work";
    case Failure::heating:
      return "heating";
    case Failure::creep:
      return "creep";
    case Failure::far_origin:
      return "far origin";
    case Failure::resolution:
      return "resolution";
  }
  return "?";
}

}  // namespace cuboct
