// A curve in the midst of a program: whether its blocks may be followed as one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "gcode/curves/curve_format.h"
#include "gcode/state/block_flow.h"
#include "gcode/state/control_state.h"
#include "gcode/state/motion.h"

namespace batten::gcode {

class CurveFormat;

// The curve that starts in block `first`. Nothing where `format` is nullptr or reads none there, in
// states in which the path is not what the words say or in which the control refuses curves, and
// when one of its blocks may be left out, is jumped to or stands in a loop.
[[nodiscard]] std::optional<CurveReading> curve_at(const Program& program, std::uint32_t first,
                                                   const ControlState& state,
                                                   const CurveFormat* format,
                                                   std::span<const BlockFlow> flow);

// Whether the feed of the curve that starts in block `first` is written without a decimal point.
[[nodiscard]] bool is_feed_without_point(const Program& program, std::uint32_t first,
                                         const CurveReading& curve);

// One of the curve's pieces as a motion.
[[nodiscard]] Motion motion_of(const CurveMotion& piece, const CurveReading& curve);

}  // namespace batten::gcode
