// Marks by which the language of a program is known for certain: no other language has them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "gcode/text/language.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

struct LanguageEvidence {
  Language language = Language::kRs274;
  std::string_view evidence;  // what was found: "BEGIN PGM"
};

// What the line says, when it is one that only such a language has: `0 BEGIN PGM NAME MM`,
// `%_N_NAME_MPF`, `;$PATH=..`, `DEF REAL ..`. RS-274 has no such lines.
[[nodiscard]] std::optional<LanguageEvidence> language_of_line(std::string_view line);

struct LanguageMark {
  Language language = Language::kRs274;
  std::string_view evidence;
  SourceSpan where;  // its line
};

// The first mark of each language that has any, in the order of the text. Linear in the text.
[[nodiscard]] std::vector<LanguageMark> language_marks(const SourceText& source);

}  // namespace batten::gcode
