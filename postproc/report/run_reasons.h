// Why runs were kept, counted.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "postproc/stream/run_report.h"

namespace batten::postproc {

struct ReasonCount {
  std::string_view id;      // gcode::reason
  std::string_view text;    // what it means, for the user
  std::string_view advice;  // what the user can do; may be empty
  bool can_be_allowed = false;
  std::size_t runs = 0;
  std::size_t blocks = 0;
};

// One entry per reason of the kept runs: the most blocks first, then by id.
[[nodiscard]] std::vector<ReasonCount> count_reasons(std::span<const RunReport> runs);

}  // namespace batten::postproc
