// Room for what is held once per block of a long program. Touching such room for the first time
// costs a call of the system for each of its pages, as long as reading the block that goes there:
// with pages of some megabytes that is nothing.
#pragma once

#include <cstddef>
#include <vector>

namespace batten::gcode {

// Asks the system for large pages, where it has such, before the room is touched. An advice: it
// changes no byte, and small rooms are left alone.
void prefer_large_pages(void* room, std::size_t bytes);

// Room for so many items in an empty list.
template <typename Item>
void reserve_in_large_pages(std::vector<Item>& items, std::size_t count) {
  items.reserve(count);
  prefer_large_pages(items.data(), items.capacity() * sizeof(Item));
}

}  // namespace batten::gcode
