// SPDX-License-Identifier: MIT
// Whether this is compiled with the address or the thread sanitizer. Both reserve terabytes of addresses, so
// that no program of theirs starts within a limit of these (RLIMIT_AS).
#pragma once

namespace cuboct {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)  // Clang
inline constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace cuboct
