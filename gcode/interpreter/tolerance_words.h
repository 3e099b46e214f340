// Reads how exact a part of a program has to be: a comment of the CAM system, or the words by which
// a control is told. Types: gcode/state/stated_tolerance.h.
#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/state/stated_tolerance.h"

namespace batten::gcode {

struct ToleranceWords {
  enum class Kind : std::uint8_t {
    kNone,       // it is about something else
    kStated,     // `length`
    kEnded,      // none is asked for any more
    kUncertain,  // it names a tolerance, but no length that is certain
  };
  Kind kind = Kind::kNone;
  StatedLength length = {};
};

// Of a comment, with its brackets or semicolon. It states one where it says that and nothing else:
//
//   [CUT | CUTTING | MACHINING | TOTAL] TOLERANCE | TOLERANZ | TOL
//   [: | = | - between blanks] a number > 0 without sign, with a point where it has decimals
//   [MM | IN | INCH | INCHES]
//
// in capitals or not. It is uncertain where it begins with TOLERANCE or TOLERANZ and goes on
// otherwise, or where one of these names, INTOL or OUTTOL stands anywhere with a number behind it.
[[nodiscard]] ToleranceWords tolerance_in_comment(std::string_view comment);

// Of a block of a Siemens program with CYCLE832(tolerance, mode ..); mm. CYCLE832(), CYCLE832
// alone, a tolerance of 0 and the mode _OFF end it.
[[nodiscard]] ToleranceWords tolerance_in_cycle832(std::string_view block);

// Of a statement of Klartext, without number and comment: CYCL DEF 32.1 T0.05; mm. It ends without
// a T.
[[nodiscard]] ToleranceWords tolerance_in_cycle32(std::string_view statement);

}  // namespace batten::gcode
