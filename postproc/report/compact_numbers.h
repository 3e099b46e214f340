// Columns of whole numbers as short text, for a page that reads them with a few lines of script.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace batten::postproc {

// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

// Each number as zigzag (0, -1, 1, -2 .. become 0, 1, 2, 3 ..) in groups of seven bits, the lowest
// first; all but the last group of a number have the top bit set. Then base64.
[[nodiscard]] std::string packed(const std::vector<std::int64_t>& numbers);

// The differences between neighbours, the first one from 0; packed.
[[nodiscard]] std::string packed_steps(const std::vector<std::int64_t>& numbers);

// Value, count, value, count ..; packed.
[[nodiscard]] std::string packed_runs(const std::vector<std::int64_t>& numbers);

// The same of the differences: for numbers that mostly go on by the same step.
[[nodiscard]] std::string packed_step_runs(const std::vector<std::int64_t>& numbers);

}  // namespace batten::postproc
