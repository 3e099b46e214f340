// How long the processor has worked: what else the machine does does not count, or hardly.
#pragma once

#include <algorithm>
#include <ctime>
#include <limits>

namespace batten {

// Seconds of this thread, from when it began.
inline double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Seconds that `work` takes, the least of so many times.
template <typename Work>
double least_processor_seconds(int times, const Work& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < times; ++i) {
    const double start = processor_seconds();
    work();
    least = std::min(least, processor_seconds() - start);
  }
  return least;
}

}  // namespace batten
