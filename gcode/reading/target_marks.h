// For which control a program was made, by what its beginning says: for a user who names none.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/source_text.h"

namespace batten::gcode {

struct TargetMarks {
  // Certain: the post that wrote the program says its name, and writes for one control or for some
  // that take the same words; or only one family reads the language. Else empty.
  std::string_view target;
  std::string evidence;                  // "line 2 says (Post Processor: grbl_post)"; may be empty
  std::vector<std::string_view> likely;  // where it is not certain: the likeliest first
};

// By the first 64 KiB.
[[nodiscard]] TargetMarks target_marks(const SourceText& source);

}  // namespace batten::gcode
