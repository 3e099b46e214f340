// Block numbers of Klartext programs, which rise by one. Copied blocks keep theirs, so new ones
// take the numbers of those that they replace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/program.h"

namespace batten::postproc {

struct LineNumberRange {
  std::optional<std::uint32_t> first;  // nothing: the blocks there have no numbers
  // How many blocks fit before the number of the first block behind them.
  std::size_t blocks = std::numeric_limits<std::size_t>::max();
};

// In the place of these blocks (indices, both inclusive). Languages other than Klartext have no
// numbers that count.
[[nodiscard]] LineNumberRange number_room(const gcode::Program& program, std::uint32_t first_block,
                                          std::uint32_t last_block);

// Lines that take a number: those that do not begin with a blank, which continue a block.
[[nodiscard]] std::size_t numbered_lines(std::string_view text);

// Each of those lines with its number before it, from `first` on; numbers that are there already
// are replaced.
[[nodiscard]] std::string with_numbers(std::string_view text, std::uint32_t first);

}  // namespace batten::postproc
