// How long the processor has worked: what else the machine does does not count, or hardly.
#pragma once

#include <ctime>

namespace batten {

// Seconds of this thread, from when it began.
inline double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace batten
