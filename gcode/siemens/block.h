// One line of a Siemens program to words and comments, and how far it is understood.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

struct SiemensBlock {
  ParseStatus opacity = ParseStatus::kNone;
  bool skip = false;  // starts with /, or /0 to /9
  std::optional<SourceSpan> comment;
  std::string_view trouble;  // kUnreadable: what cannot be read, for people
  SourceSpan trouble_at;
};

// Adds the words of the line, which is a span of `source` without its line end, to `words`: those
// of one letter, and CR= as R. With ParseStatus::kNamedWords the others are to be looked up
// (gcode/siemens/names.h).
[[nodiscard]] SiemensBlock read_siemens_block(std::string_view source, SourceSpan line,
                                              std::vector<Word>& words);

// Whether a G word means what it means on controls of the RS-274 family, as far as the interpreter
// follows it; `value` as written.
[[nodiscard]] bool is_common_siemens_g(double value);

}  // namespace batten::gcode
