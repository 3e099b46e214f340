#include "postproc/batch/batch_progress.h"

#include <fmt/format.h>

#include "postproc/system/progress_text.h"

namespace batten::postproc {

namespace {

constexpr std::size_t kBarWidth = 20;  // characters, so that the line fits into 80

std::string bar_of(std::size_t part, std::size_t whole) {
  const std::size_t full = whole > 0 ? kBarWidth * part / whole : kBarWidth;
  return "[" + std::string(full, '#') + std::string(kBarWidth - full, '-') + "]";
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

}  // namespace batten::postproc
