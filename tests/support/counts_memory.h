// Whether what a process takes of memory is what the program asked for.
#pragma once

namespace batten {

#if !defined(__has_feature)  // GCC says it by a macro, Clang by this
#define __has_feature(feature) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
constexpr bool kCountsMemory =
    false;  // the sanitizer needs terabytes of addresses, and some memory
#else
constexpr bool kCountsMemory = true;
#endif

}  // namespace batten
