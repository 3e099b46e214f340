#include "postproc/batch/batch_progress.h"

#include <fmt/format.h>

#include <cmath>

namespace batten::postproc {

namespace {

constexpr std::size_t kBarWidth = 20;  // characters, so that the line fits into 80

std::string bar_of(std::size_t part, std::size_t whole) {
  const std::size_t full = whole > 0 ? kBarWidth * part / whole : kBarWidth;
  return "[" + std::string(full, '#') + std::string(kBarWidth - full, '-') + "]";
}

std::string rate_text(double bytes_per_second) {
  if (bytes_per_second >= 1e6) return fmt::format("{:.1f} MB/s", bytes_per_second / 1e6);
  return fmt::format("{:.0f} kB/s", bytes_per_second / 1e3);
}

}  // namespace

std::string progress_line(const BatchCount& count) {
  std::string line =
      fmt::format("{}  {} of {} programs", bar_of(count.programs_over, count.programs),
                  count.programs_over, count.programs);
  if (count.bytes_over == 0 || !(count.seconds > 0)) return line;
  const double rate = static_cast<double>(count.bytes_over) / count.seconds;
  line += "  " + rate_text(rate);
  if (count.bytes > count.bytes_over) {
    line += fmt::format("  about {} left",
                        rough_time(static_cast<double>(count.bytes - count.bytes_over) / rate));
  }
  return line;
}

std::string rough_time(double seconds) {
  if (seconds <= 60) return fmt::format("{:.0f} s", std::ceil(seconds));
  const auto minutes = static_cast<long long>(std::ceil(seconds / 60));
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

}  // namespace batten::postproc
