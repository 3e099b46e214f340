// The report of `batten smooth` for programs: one JSON object, its fields always in the same
// order, the same bytes for the same input and options (threads do not show).
//
//   batten, options, input, output, runs[], reasons[], deviation_mm, deviation_line,
//   time_before_s, time_after_s, proved, understood, diagnostics[], and profile where one
//   was given
//
// Bytes of names and messages that are not UTF-8 become U+FFFD; numbers that are not finite
// become null.
#pragma once

#include <string>

#include "postproc/report/smooth_report.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// The object itself.
[[nodiscard]] Json smooth_json(const SmoothReport& report);

[[nodiscard]] std::string json_report(const SmoothReport& report);

}  // namespace batten::postproc
