// How much is said on standard error.
#pragma once

#include <span>

#include "postproc/options/options.h"

namespace batten::postproc {

enum class LogLevel {
  kError,    // what ends or stops the work
  kWarning,  // and what is doubtful in a program
  kInfo,     // and notes, the summary, progress
};

[[nodiscard]] std::span<const Choice<LogLevel>> log_levels();

}  // namespace batten::postproc
