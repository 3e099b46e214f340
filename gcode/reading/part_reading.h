// A program of the RS-274 family read part by part, each part with what the ones before it have
// left behind: for programs that are too long to be held as blocks.
//
// The blocks, motions and states of the parts, one part after the other, are those of the whole
// (gcode::parse, gcode::interpret; gcode/interpreter/interpreter.h), and so are the diagnostics
// behind the finish_ functions, where
//   - no part reaches out: TextCarry::marks says so of its % lines, ControlCarry::reaches_out of
//     jumps, loops and subprograms, TextCarry::uses_variables of variables;
//   - no part begins within a curve that ReadOptions::curves reads;
//   - the program is none for a lathe: ControlCarry::lathe says so at its end.
// Places are places of the source, lines are lines of it. Indices (Motion::block and the like)
// begin anew in each part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/decimal_points.h"
#include "gcode/reading/program_marks.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/state/motion.h"
#include "gcode/state/source_marks.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// Where a part ends: what comes first.
struct PartEnd {
  std::uint32_t byte = std::numeric_limits<std::uint32_t>::max();  // the begin of a line
  std::size_t blocks = std::numeric_limits<std::size_t>::max();    // so many of them
};

// Where a part from `begin` (bytes) on ends that has so many bytes, and the rest of its last line:
// behind a line feed, or at the end of the text. Nothing where that rest is longer than
// `longest_rest`.
[[nodiscard]] std::optional<std::uint32_t> end_of_lines(const SourceText& source,
                                                        std::uint32_t begin, std::size_t bytes,
                                                        std::size_t longest_rest);

// Where the next part begins, and what the text before it said. As given: the whole begins.
struct TextCarry {
  std::uint32_t begin = 0;                 // bytes
  std::uint32_t blocks = 0;                // lines before it
  std::optional<std::size_t> content_end;  // of the whole: only filling and line ends behind it
  bool short_ways = true;                  // as Reading::short_ways
  bool words_seen = false;
  bool foreign_told = false;
  bool assigns = false;         // a variable
  bool uses_variables = false;  // behind that
  ToldCount unreadable;
  ToldCount unclosed;
  PercentMarkScanner marks;
  DecimalPoints decimals;
};

// The next part; `carry` then stands behind it. No blocks: the text is at its end.
[[nodiscard]] Program parse_part(const SourceText& source, const PartEnd& end, TextCarry& carry,
                                 Diagnostics& found);

// What is told of the whole text at its end. `found` has the diagnostics of its parts, and no
// others; they are put in order.
void finish_text(const TextCarry& carry, Diagnostics& found);

// Consecutive blocks of a program and what they do: what is held at a time.
struct ReadPart {
  Program program;
  Interpretation meaning;
};

// The blocks from `first` on become a part of their own, as if it had been read behind the others,
// which stay. No curve of several blocks (BlockMeaning::of_curve) is cut.
[[nodiscard]] ReadPart take_rest(ReadPart& part, std::uint32_t first);

// `more` was read directly behind `part`: both as if they had been read as one.
void append(ReadPart& part, ReadPart more);

}  // namespace batten::gcode
