#include "postproc/system/progress_text.h"

#include <fmt/format.h>

#include <cmath>

namespace batten::postproc {

std::string rate_text(double bytes_per_second) {
  if (bytes_per_second >= 1e6) return fmt::format("{:.1f} MB/s", bytes_per_second / 1e6);
  return fmt::format("{:.0f} kB/s", bytes_per_second / 1e3);
}

std::string rough_time(double seconds) {
  if (seconds <= 60) return fmt::format("{:.0f} s", std::ceil(seconds));
  const auto minutes = static_cast<long long>(std::ceil(seconds / 60));
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

}  // namespace batten::postproc
