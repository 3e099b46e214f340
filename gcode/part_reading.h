// A program of the RS-274 family read part by part, each part with what the ones before it have
// left behind: for programs that are too long to be held as blocks.
//
// The blocks, motions and states of the parts, one part after the other, are those of the whole
// (gcode::parse, gcode::interpret), and so are the diagnostics behind the finish_ functions, where
//   - no part reaches out: TextCarry::marks says so of its % lines, ControlCarry::reaches_out of
//     jumps, loops and subprograms;
//   - no part begins within a curve that ReadOptions::curves reads;
//   - the program is none for a lathe: ControlCarry::lathe says so at its end.
// Places are places of the source, lines are lines of it. Indices (Motion::block and the like)
// begin anew in each part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "gcode/control_state.h"
#include "gcode/decimal_points.h"
#include "gcode/diagnostic.h"
#include "gcode/interpreter.h"
#include "gcode/lathe_marks.h"
#include "gcode/motion.h"
#include "gcode/program.h"
#include "gcode/program_marks.h"
#include "gcode/source_text.h"
#include "gcode/told_troubles.h"

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

// Where the next part begins, and what the text before it said. As it stands: the whole begins.
struct TextCarry {
  std::uint32_t begin = 0;                 // bytes
  std::uint32_t blocks = 0;                // lines before it
  std::optional<std::size_t> content_end;  // of the whole: only filling and line ends behind it
  bool short_ways = true;                  // as Reading::short_ways
  bool words_seen = false;
  bool foreign_told = false;
  ToldCount unreadable;
  ToldCount unclosed;
  MarkWatch marks;
  DecimalPoints decimals;
};

// The next part; `carry` then stands behind it. No blocks: the text is at its end.
[[nodiscard]] Program parse_part(const SourceText& source, const PartEnd& end, TextCarry& carry,
                                 Diagnostics& found);

// What is told of the whole text at its end. `found` has the diagnostics of its parts, and no
// others; they are put in order.
void finish_text(const TextCarry& carry, Diagnostics& found);

// What the control knows where the next part begins.
struct ControlCarry {
  explicit ControlCarry(Units units) : unit_word_seen(units != Units::kUnknown) {
    state.modal.units = units;
  }
  ControlState state;
  bool unit_word_seen;
  bool is_klartext = false;  // such programs are read as a whole
  bool any_motion = false;
  SourceSpan first_motion;   // its block
  bool reaches_out = false;  // a part was not for itself, see above
  LatheWatch lathe;          // of all parts so far
  ToldTroubles told;
};

// ReadOptions::units counts only where the carry is made.
[[nodiscard]] Interpretation interpret_part(const Program& part, const ReadOptions& options,
                                            ControlCarry& carry, Diagnostics& found);

// What is told of the whole program at its end.
void finish_interpretation(const ControlCarry& carry, Diagnostics& found);

}  // namespace batten::gcode
