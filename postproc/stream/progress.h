// How far the work is, on standard error, and whether the user wants it to stop.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "postproc/options/options.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

enum class ProgressStyle {
  kAuto,  // kLinuxcnc when AXIS_PROGRESS_BAR=1, else kOn on a terminal, else kOff
  kOn,    // one line that is written over
  kOff,
  kLinuxcnc,  // lines FILTER_PROGRESS=nn, as LinuxCNC reads them from a filter program
};

[[nodiscard]] std::span<const Choice<ProgressStyle>> progress_styles();

// " 43 %  1.2 MB/s  about 5 s left": how much of so many bytes is done, after so many seconds. The
// rate and what is left stand there once they say something.
[[nodiscard]] std::string progress_line(double part, std::size_t bytes, double seconds);

// For smooth_program: shows the part of the program's bytes that is done, and returns false after
// Ctrl-C or SIGTERM (postproc/system/interrupt.h). May be called from several threads.
[[nodiscard]] Progress show_progress(ProgressStyle style, std::size_t bytes);

}  // namespace batten::postproc
