// What the words of a block say about its motion along X, Y, Z; and the fast path for nearly all
// blocks of a long program: straight lines, with N, G0 or G1 and F beside X, Y and Z at most.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/interpreter/program_flow.h"
#include "gcode/interpreter/word_applier.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/path/path.h"

namespace batten::gcode {

struct ArcWords {
  geometry::Point3 start = geometry::Point3::Zero();  // mm
  geometry::Point3 end = geometry::Point3::Zero();    // mm
  PlaneAxes plane;
  bool clockwise = false;                       // G2, seen from the tip of the normal
  bool center_absolute = false;                 // G90.1
  std::array<std::optional<double>, 3> center;  // I, J, K in mm
  std::optional<double> radius;                 // R in mm
};

struct ArcReading {
  std::optional<geometry::Arc> arc;
  std::string_view problem;  // id of the diagnostic when there is no arc
  std::string message;
};

// With R the arc of less than half a turn is meant when R > 0, the other one when R < 0. With
// a centre, an end at the start means a full turn.
//
// Problems: arc-centre-missing (no I, J, K of the plane and no R; with absolute centres both
// are needed), arc-words-conflict (R beside I, J, K; a word of I, J, K along the normal of the
// plane that is not 0), arc-radius-mismatch, arc-radius-too-small (the ends are more than 2 R
// apart, or R meets no chord).
[[nodiscard]] ArcReading arc_from_words(const ArcWords& words);

// Why the motion of a block cannot be followed in this state; empty when it can. `effect` is
// that of the block's other words.
[[nodiscard]] std::string_view why_not_followed(const BlockWords& words, const StateEffect& effect,
                                                const ControlState& state);

// Where the axis words lead, in mm. An increment from an unknown position leads to an unknown one.
// With unknown units the numbers stand for themselves: such motions are never rewritten.
[[nodiscard]] Position end_of_motion(const BlockWords& words, const ControlState& state);

// The arc of G2 or G3 from the state's position to `end`. Requires a known plane.
[[nodiscard]] ArcWords arc_words(const BlockWords& words, const ControlState& state,
                                 const Position& end);

// Does with such a plain line of the RS-274 family what the interpreter does with it: adds its meaning,
// its motion and what state is new to `read` and goes to its end. False, and nothing done, where
// the block or the state is of another kind. `now`: the last of `read.states`, and the place before
// the block.
[[nodiscard]] bool read_plain_line(const Program& program, std::uint32_t index,
                                   const BlockFlow& flow, ControlState& now, Interpretation& read);

}  // namespace batten::gcode
