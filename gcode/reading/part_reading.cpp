#include "gcode/reading/part_reading.h"

#include <string_view>

namespace batten::gcode {

std::optional<std::uint32_t> end_of_lines(const SourceText& source, std::uint32_t begin,
                                          std::size_t bytes, std::size_t longest_rest) {
  const std::string_view text = source.text();
  if (text.size() - begin <= bytes) return static_cast<std::uint32_t>(text.size());
  const std::size_t from = begin + bytes;
  const std::size_t feed = text.substr(from, longest_rest).find('\n');
  if (feed == std::string_view::npos) return std::nullopt;
  return static_cast<std::uint32_t>(from + feed + 1);
}

}  // namespace batten::gcode
