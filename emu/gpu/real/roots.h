// SPDX-License-Identifier: MIT
// 1/a and 1/sqrt(a) without the special cases (0, denormals, infinities) that cost as much as the rest.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "model/base/fixed_math.h"

namespace cuboct::gpu {

// For normal a > 0 whose results are normal. Relative errors, with u = 2^-24 in floats, 2^-53 in doubles:
//   floats   inverse 2^-23 = 2u, inverse_root 2^-22.4 = 3.1u on the device (PTX ISA, rcp.approx.ftz.f32 and
//            rsqrt.approx.ftz.f32); u and 1.5u on the host
//   doubles  4u on both. The device's first guess y takes and gives the upper words alone: 2^-20 of the
//            argument and of the result are lost, so that e = 1 - a y is below 2^-18.9 (1 - a y^2: 2^-18.4),
//            and what the series drops, e^3 (5/16 e^3), is below u/4. The rest are the roundings of e, of the
//            product with y and of the last sum.
struct FastRoots {
  CUBOCT_HD static float inverse(float a) {
#ifdef __CUDA_ARCH__
    float y;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(a));
    return y;
#else
    return 1 / a;
#endif
  }
  CUBOCT_HD static float inverse_root(float a) {
#ifdef __CUDA_ARCH__
    float y;
    asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(a));
    return y;
#else
    return 1 / std::sqrt(a);
#endif
  }
  // 1/a = y/(1 - e) = y (1 + e + e^2 + ...)
  CUBOCT_HD static double inverse(double a) {
#ifdef __CUDA_ARCH__
    double y;
    asm("rcp.approx.ftz.f64 %0, %1;" : "=d"(y) : "d"(a));
#else
    const double y = upper_word(1 / upper_word(a));
#endif
    const double e = 1 - a * y;
    return y + y * (e + e * e);
  }
  // 1/sqrt(a) = y/sqrt(1 - e) = y (1 + e/2 + 3/8 e^2 + ...)
  CUBOCT_HD static double inverse_root(double a) {
#ifdef __CUDA_ARCH__
    double y;
    asm("rsqrt.approx.ftz.f64 %0, %1;" : "=d"(y) : "d"(a));
#else
    const double y = upper_word(1 / std::sqrt(upper_word(a)));
#endif
    const double e = 1 - a * (y * y);
    return y + y * (e * (0.5 + 0.375 * e));
  }

 private:
  static double upper_word(double a) {
    return std::bit_cast<double>(std::bit_cast<uint64_t>(a) & 0xffffffff00000000);
  }
};

}  // namespace cuboct::gpu
