// How much has been computed. Whatever takes long counts its operations, so that work can be
// bounded by numbers that are the same on every machine, for any number of threads.
//
// One operation is about what one sample of a curve takes in one solution of its fit
// (geometry/fitting/bspline_fit.h): some 60 ns on a machine of 2020.
#pragma once

#include <cstddef>
#include <cstdint>

namespace batten::geometry {

namespace detail {
inline thread_local std::uint64_t operations_done = 0;
}

// Of this thread, since it began.
[[nodiscard]] inline std::uint64_t operations_so_far() { return detail::operations_done; }

inline void count_operations(std::size_t operations) { detail::operations_done += operations; }

}  // namespace batten::geometry
