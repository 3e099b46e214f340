#include "postproc/stream/smooth_verdict.h"

#include <algorithm>

#include "gcode/state/reason.h"

namespace batten::postproc {

namespace {

bool has_unproved_run(const SmoothResult& result) {
  return std::ranges::any_of(result.runs, [](const RunReport& run) {
    return run.status == RunStatus::kKept && run.reason == gcode::reason::kNotProved;
  });
}

}  // namespace

ExitCode judge(const SmoothResult& result, std::string_view source, bool strict) {
  if (!result.understood) return ExitCode::kNotUnderstood;
  // The same bytes need no proof: programs with words that cannot be followed come out as they
  // were.
  const bool proved = result.proved || result.text == source;
  if (!proved || (strict && has_unproved_run(result))) return ExitCode::kNotProved;
  return ExitCode::kDone;
}

std::string_view complaint(ExitCode verdict, bool strict) {
  if (verdict == ExitCode::kNotUnderstood) {
    return "the program is not understood well enough to be rewritten; nothing was written";
  }
  return strict ? "--strict: not every run could be proved; nothing was written"
                : "the new program could not be proved; nothing was written";
}

}  // namespace batten::postproc
