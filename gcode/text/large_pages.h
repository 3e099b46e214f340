// Room for what is held once per block of a long program. Touching such room for the first time
// costs a call of the system for each of its pages, as long as reading the block that goes there:
// with pages of some megabytes that is nothing.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace batten::gcode {

// Room for so many items in an empty list. Asks the system for large pages, where it has such,
// before the room is touched. An advice: it changes no byte, and small rooms are left alone.
template <typename Item>
void reserve_in_large_pages(std::vector<Item>& items, std::size_t count) {
  constexpr std::uintptr_t kLargePage = std::uintptr_t{1} << 21;  // of x86-64 and 64 bit ARM
  items.reserve(count);
  const auto from = reinterpret_cast<std::uintptr_t>(items.data());
  const std::uintptr_t bytes = items.capacity() * sizeof(Item);
  const std::uintptr_t first = (from + kLargePage - 1) / kLargePage * kLargePage;
  const std::uintptr_t last = (from + bytes) / kLargePage * kLargePage;
  if (bytes == 0 || first >= last) return;
  (void)::madvise(reinterpret_cast<char*>(items.data()) + (first - from), last - first,
                  MADV_HUGEPAGE);
}

}  // namespace batten::gcode
