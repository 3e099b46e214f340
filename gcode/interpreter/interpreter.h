// Blocks to motions in millimetres: the only place that knows inches and increments.
#pragma once

#include <cstddef>
#include <memory>

#include "gcode/interpreter/lost_modes.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/state/own_words.h"
#include "gcode/state/source_marks.h"
#include "gcode/state/subprograms.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// What the control knows where the next part begins.
struct ControlCarry {
  explicit ControlCarry(Units units) : unit_word_seen(units != Units::kUnknown) {
    state.modal.units = units;
  }
  ControlState state;
  bool unit_word_seen;
  bool is_klartext = false;  // such programs are read as a whole
  bool any_words = false;    // more than comments, program numbers and titles
  bool any_motion = false;
  SourceSpan first_motion;   // its block
  bool reaches_out = false;  // a part was not for itself (gcode/reading/part_reading.h)
  LatheWatch lathe;          // of all parts so far
  DiagnosticLimiter told;
  LostModes lost;
  std::size_t called_blocks = 0;  // that were followed in called programs
};

inline constexpr std::size_t kMostCalledBlocks = 2'000'000;
inline constexpr int kMostCalledWithin = 10;

struct CurveFormat;  // gcode/curves/curve_format.h

struct ReadOptions {
  Units units = Units::kUnknown;  // --units: what a program that names no unit means
  // The curves of the control that the program is for; all others are motions that cannot be
  // followed. nullptr: none are read.
  const CurveFormat* curves = nullptr;
  // Subprograms and macros leave all modes as they find them (M97, M98, M198, G65, O-word calls,
  // CALL LBL, CALL PGM): behind a call only place, feed, speed and kind of motion are unknown.
  bool calls_keep_modes = false;
  // What the control that the program is for does not have (Control::lacks): that cannot be on
  // behind a block that is not understood.
  ModeSet lacks = 0;
  ModeSet asked = mode::kAll;  // without which moves are told to be copied (modes-unknown)
  // Most builds of the control leave out a block without a G, M or T word: what it would change is
  // unknown behind it.
  bool needs_commands = false;
  bool names_blocks = false;             // NAT01 names a block, OPART the program: they do nothing
  bool centers_follow_distance = false;  // I J K are places under G90, offsets under G91
  // A program that others call is called under the modes of power-on. Otherwise nothing is known of
  // what it does not set itself, and its blocks are kept.
  bool usual_caller_modes = false;
  // What the program says of how exact its parts have to be counts
  // (gcode/interpreter/tolerance_words).
  bool stated_tolerances = true;
  std::shared_ptr<const OwnWords> own_words = nullptr;  // what the user vouches for; nullptr: none
  std::shared_ptr<const Subprograms> subprograms = nullptr;  // the files of called programs
  bool short_ways = true;  // for plain lines (read_plain_line); they change nothing
};

// Follows the program from its first block to its last, as a control would, without loops
// and calls: blocks that would need them are opaque, and what they could have changed is
// unknown after them. A call of one of ReadOptions::subprograms is followed through it: what is
// known behind it is what the called program leaves from what is known at the call. In one program
// so many blocks are followed in called ones, and so many calls within each other, as kMostCalled..
// say; behind further calls everything is unknown.
//
// State at the start: units as in the options; everything else as controls have it after
// power-on (absolute, XY plane, feed per minute, compensations off), the position unknown.
//
// A block behind which the modes are not known, and moves are copied for that, gives the warning
// modes-unknown.
//
// What names a tolerance, but none that is certain, gives the note tolerance-uncertain; what was
// said before it still holds.
//
// What most controls would refuse (two words of one group, an arc whose radii differ by more
// than 0.0283 mm and 0.1 %) gives a warning; the block is opaque then. The only error is
// units-missing: motions in a program that names no unit, without ReadOptions::units. At most
// one diagnostic per block. Linear time.
//
// A program for a lathe (gcode/state/source_marks.h) gives one warning, lathe-program: nothing of
// it is followed, all its blocks that say anything are opaque. Its motions are listed as a mill
// would do them, so that they can be counted.
//
// Positions are those of the program's own coordinates. In states that no motion may be
// rewritten in (scaling, rotation, tilted planes ..) they are not where the tool is.
[[nodiscard]] Interpretation interpret(const Program& program, const ReadOptions& options,
                                       Diagnostics& found);

// ReadOptions::units counts only where the carry is made.
[[nodiscard]] Interpretation interpret_part(const Program& part, const ReadOptions& options,
                                            ControlCarry& carry, Diagnostics& found);

// What is told of the whole program at its end.
void finish_interpretation(const ControlCarry& carry, Diagnostics& found);

}  // namespace batten::gcode
