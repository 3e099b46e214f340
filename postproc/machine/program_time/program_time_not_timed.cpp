#include "postproc/machine/program_time/program_time_not_timed.h"

#include <algorithm>
#include <array>

#include "gcode/state/reason.h"

namespace batten::postproc {
namespace {

namespace reason = gcode::reason;

struct NotTimedText {
  std::string_view id;
  std::string_view text;
};

constexpr std::array kTexts = {
    NotTimedText{
        not_timed::kPlaceUnknown,
        "the tool's position before the move is not known: the axes without one take no time"},
    NotTimedText{not_timed::kPlaceAssumed,
                 "after a tool change or an offset: timed from the last programmed position"},
    NotTimedText{reason::kFeedUnknown, "no feed is known: timed as fast as the machine cuts"},
    NotTimedText{not_timed::kSpindleUnknown,
                 "feed per revolution without a known spindle speed: timed as fast as the machine "
                 "cuts"},
    NotTimedText{not_timed::kRotaryAxis, "A, B, C, U, V or W move too: only X, Y and Z are timed"},
    NotTimedText{not_timed::kPathChanged,
                 "cutter compensation, scaling, rotation or the like is on: timed as programmed"},
    NotTimedText{reason::kLoopBody, "in a loop or subprogram: timed once"},
    NotTimedText{not_timed::kDwellUnknown, "a dwell whose length is not known: not timed"},
    NotTimedText{not_timed::kDwellAssumed,
                 "G4 P without a decimal point: taken for milliseconds (--target decides)"},
    NotTimedText{not_timed::kReferenceMove,
                 "G28, G30, G53: the path to a machine position is not timed"},
    NotTimedText{not_timed::kOperatorStop, "M0, M1, M60: waits for the operator, not timed"},
    NotTimedText{reason::kMiscFunction,
                 "M functions of the machine's builder or the user: not timed"},
    NotTimedText{reason::kCannedCycle, "canned cycles that are not followed: not timed"},
    NotTimedText{reason::kSpline, "splines (G5, G6.2 ..): not timed"},
    NotTimedText{reason::kProbe, "probing moves: not timed"},
    NotTimedText{reason::kThreading, "threading and tapping moves: not timed"},
    NotTimedText{reason::kSubprogram, "calls of subprograms and macros: not timed"},
    NotTimedText{reason::kProgramFlow, "jumps, loops and calls: not followed"},
    NotTimedText{reason::kExpression, "words with parameters or expressions: not timed"},
    NotTimedText{reason::kBlockDelete, "blocks with / : not timed"},
    NotTimedText{reason::kStateUnknown,
                 "moves in a state that is not known (after a call or an unknown word): not timed"},
    NotTimedText{reason::kPositionUnknown, "arcs from a position that is not known: not timed"},
    NotTimedText{reason::kArc, "arcs that are not understood: not timed"},
    NotTimedText{not_timed::kAfterEnd, "blocks after the end of the program (M2, M30): not timed"},
};

std::string_view text_of(std::string_view id) {
  for (const NotTimedText& known : kTexts) {
    if (known.id == id) return known.text;
  }
  for (const auto& known : reason::explanations()) {
    if (known.id == id) return known.text;
  }
  return "not understood: not timed";
}

}  // namespace

void NotTimedList::add(std::string_view id, std::uint32_t line) {
  const auto known = std::ranges::find(entries_, id, &NotTimed::id);
  if (known == entries_.end()) {
    entries_.push_back({id, text_of(id), 1, line});
  } else {
    ++known->count;
  }
}

}  // namespace batten::postproc
