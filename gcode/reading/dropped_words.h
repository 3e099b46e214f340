// Words by which a control is told how to follow a path, and which have no meaning to another one:
// a user may drop them by name.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/source_text.h"

namespace batten::gcode {

// "G64", "G187", "G5.1", "G5". None of them moves, changes what other words mean, or stops.
[[nodiscard]] std::vector<std::string_view> droppable_words();

// The name under which this word ("G64", "g05.1") can be dropped; empty where it cannot.
[[nodiscard]] std::string_view droppable_name(std::string_view word);

// The text without these words and their numbers; line ends stay, so that lines keep their numbers.
// `dropped`: how many there were. A word stays where it is not certain what would go with it:
// beside codes that may own its letters, as curves (G5, G5.1 with axes), behind a block delete
// sign, in lines with a check sum or an expression, in programs in other languages than RS-274, and
// G64 where the program has G61, G62 or G63, which it may be there to end.
[[nodiscard]] SourceText without_words(const SourceText& source,
                                       const std::vector<std::string>& names, std::size_t& dropped);

}  // namespace batten::gcode
