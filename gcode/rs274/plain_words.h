// The way of nearly all lines of a long program through the reader: letters with a short number
// each, and nothing else.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/text/line_cursor.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// Reads the line of the RS-274 family that begins at byte `begin` of `text`, and appends the words
// that the common way through the lexer gives. Nothing, and no words, where the line is of another
// kind: comments, expressions, codes such as O and %, blanks within a word, numbers of more digits
// than a double holds, ends of lines other than LF and CR LF. A line of blanks has no words.
[[nodiscard]] std::optional<LineBounds> read_plain_words(std::string_view text, std::size_t begin,
                                                         std::vector<Word>& words);

// Whether a text begins as programs of plain words do, and as no Klartext program can.

// The first block that says anything, behind comments, % lines and an O number, where it begins
// with a G word: `N10 G21 G90`. No statement of Klartext begins so. Reads no further than that.
[[nodiscard]] std::optional<SourceSpan> plain_beginning(const SourceText& source);

}  // namespace batten::gcode
