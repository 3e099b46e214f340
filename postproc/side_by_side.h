// Work on many things at once.
#pragma once

#include <cstddef>
#include <functional>

namespace batten::postproc {

// For SmoothOptions::threads and the like: no threads of its own, but those of the work that it is
// a part of.
inline constexpr int kThreadsOfCaller = -1;

// Calls `one` for 0 .. count - 1, in any order, on so many threads; 0: all cores. The calls must
// not look at each other.
void side_by_side(int threads, std::size_t count, const std::function<void(std::size_t)>& one);

}  // namespace batten::postproc
