// How new lines end.
#pragma once

#include <string_view>

namespace batten::postproc {

// As the line of the source does beside which they stand; never in a CR alone, which some controls
// leave out.
[[nodiscard]] constexpr std::string_view written_line_end(std::string_view of_source) {
  return of_source.starts_with('\r') ? "\r\n" : "\n";
}

}  // namespace batten::postproc
