#include "gcode/text/large_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace batten::gcode {

void prefer_large_pages(void* room, std::size_t bytes) {
  constexpr std::uintptr_t kLargePage = std::uintptr_t{1} << 21;  // of x86-64 and 64 bit ARM
  const auto from = reinterpret_cast<std::uintptr_t>(room);
  const std::uintptr_t first = (from + kLargePage - 1) / kLargePage * kLargePage;
  const std::uintptr_t last = (from + bytes) / kLargePage * kLargePage;
  if (room == nullptr || first >= last) return;
  (void)::madvise(static_cast<char*>(room) + (first - from), last - first, MADV_HUGEPAGE);
}

}  // namespace batten::gcode
