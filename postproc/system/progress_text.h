// What lines that show progress say besides how far the work is.
#pragma once

#include <string>

namespace batten::postproc {

// "850 kB/s", "1.2 MB/s"
[[nodiscard]] std::string rate_text(double bytes_per_second);

// "40 s", "2 min", "3 h 20 min": rounded up, since it is a guess.
[[nodiscard]] std::string rough_time(double seconds);

}  // namespace batten::postproc
