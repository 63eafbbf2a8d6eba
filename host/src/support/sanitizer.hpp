// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cde {

/// Whether the build uses AddressSanitizer or ThreadSanitizer (GCC or clang), whose shadows take
/// terabytes of address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kSanitizer = true;
#else
inline constexpr bool kSanitizer = false;
#endif
#else
inline constexpr bool kSanitizer = false;
#endif

}  // namespace cde
