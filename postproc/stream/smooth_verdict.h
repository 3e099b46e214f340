// Whether what `smooth_program` made may be written.
#pragma once

#include <string_view>

#include "postproc/stream/smooth_result.h"
#include "postproc/system/exit_code.h"

namespace batten::postproc {

// kDone, kNotUnderstood or kNotProved; only what is kDone may be written. `strict`: a run that was
// kept because it could not be proved counts as not proved.
[[nodiscard]] ExitCode judge(const SmoothResult& result, std::string_view source, bool strict);

// Why nothing was written, for the user. Requires a verdict other than kDone.
[[nodiscard]] std::string_view complaint(ExitCode verdict, bool strict);

}  // namespace batten::postproc
