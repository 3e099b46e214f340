#include "postproc/options/log_level.h"

#include <array>

namespace batten::postproc {
namespace {

constexpr std::array kLevels = {
    Choice<LogLevel>{LogLevel::kError, "error", "what ends or stops the work"},
    Choice<LogLevel>{LogLevel::kWarning, "warning", "and what is doubtful in a program"},
    Choice<LogLevel>{LogLevel::kInfo, "info", "and notes, the summary, progress"},
};

}  // namespace

std::span<const Choice<LogLevel>> log_levels() { return kLevels; }

}  // namespace batten::postproc
