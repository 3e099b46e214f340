// Work on many things at once.
#pragma once

#include <cstddef>
#include <functional>

namespace batten::postproc {

// For SmoothOptions::threads and the like: no threads of its own, but those of the work that it is
// a part of.
inline constexpr int kThreadsOfCaller = -1;

// How many threads work for who asks for so many: as many as there are cores at the most, and all
// of them for 0. The library would take no more either, and say so in words of its own.
[[nodiscard]] int threads_at_once(int asked);

// Calls `one` for 0 .. count - 1, in any order, on so many threads; 0: all cores. The calls must
// not look at each other.
void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& one);

}  // namespace batten::postproc
