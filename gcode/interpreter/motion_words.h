// What the words of a block say about its motion along X, Y, Z.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/interpreter/word_applier.h"
#include "gcode/state/block_words.h"
#include "gcode/state/control_state.h"
#include "gcode/state/modal_state.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// The axes of a plane, and its normal: axis0 turned counter-clockwise by 90 degrees is axis1,
// seen from the tip of the normal (XY from +Z, ZX from +Y, YZ from +X).
struct ArcAxes {
  std::size_t axis0 = 0;
  std::size_t axis1 = 1;
  std::size_t normal = 2;
};
[[nodiscard]] ArcAxes axes_of(Plane plane);  // requires a known plane

struct ArcWords {
  geometry::Point3 start = geometry::Point3::Zero();  // mm
  geometry::Point3 end = geometry::Point3::Zero();    // mm
  ArcAxes plane;
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
// are needed), arc-words-conflict (R beside I, J, K; a word of I, J, K along the
// normal of the plane that is not 0),
// arc-radius-mismatch, arc-radius-too-small (the ends are more than 2 R apart, or R meets no
// chord).
[[nodiscard]] ArcReading arc_from_words(const ArcWords& words);

// Why the motion of a block cannot be followed in this state; empty when it can. `effect` is
// that of the block's other words.
[[nodiscard]] std::string_view why_not_followed(const BlockWords& words, const StateEffect& effect,
                                                const ControlState& state);

// Where the axis words lead, in mm. An increment from an unknown place leads to an unknown one.
// With unknown units the numbers stand for themselves: such motions are never rewritten.
[[nodiscard]] Position end_of_motion(const BlockWords& words, const ControlState& state);

// The arc of G2 or G3 from the state's place to `end`. Requires a known plane.
[[nodiscard]] ArcWords arc_words(const BlockWords& words, const ControlState& state,
                                 const Position& end);

}  // namespace batten::gcode
