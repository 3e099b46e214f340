// A text part by part, so that a long file that is mapped takes little memory while it is looked
// at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gcode/text/source_text.h"

namespace batten::gcode {

// Behind a line feed where there is one, so that lines are whole.
[[nodiscard]] inline std::size_t end_of_part(std::string_view text, std::size_t begin) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 22;
  if (text.size() - begin <= kAtOnce) return text.size();
  const std::size_t feed = text.rfind('\n', begin + kAtOnce);
  return feed == std::string_view::npos || feed < begin ? text.size() : feed + 1;
}

// Calls `use` for each part of the text until it says false.
template <typename Use>
void for_each_part(const SourceText& source, const Use& use) {
  const std::size_t size = source.text().size();
  bool goes_on = true;
  for (std::size_t begin = 0; begin < size && goes_on;) {
    const std::size_t end = end_of_part(source.text(), begin);
    const SourceSpan part{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    goes_on = use(part);
    source.release_pages(part);
    begin = end;
  }
}

}  // namespace batten::gcode
