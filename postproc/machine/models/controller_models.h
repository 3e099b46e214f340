// One model per kind of control: each turns a chain of pieces into stretches with limits.
// `pieces` have a length above 0 and a feed above 0.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gcode/state/modal_state.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {

// Where a stretch runs. The way along the stretch goes evenly with the parameter of `path`.
struct StretchPlace {
  std::uint32_t first_piece = 0;  // of the chain; the stretch serves all from the first to the
  std::uint32_t last_piece = 0;   // last: lines that a control joins, the two sides of a corner
  bool is_corner = false;         // a bend that the control puts into the joint of the two
  geometry::PathPiece path;
};

struct StretchChain {
  std::vector<VelocityStretch> stretches;
  std::vector<StretchPlace> places;  // one for each stretch, or none when they are not wanted
  ProfileRules rules;
};

enum class WithPositions { kNo, kYes };

[[nodiscard]] StretchChain look_ahead_stretches(std::span<const TimedPiece> pieces,
                                                const Machine& machine, gcode::PathMode path,
                                                WithPositions places);

[[nodiscard]] StretchChain grbl_stretches(std::span<const TimedPiece> pieces,
                                          const Machine& machine, gcode::PathMode path,
                                          WithPositions places);

[[nodiscard]] StretchChain linuxcnc_stretches(std::span<const TimedPiece> pieces,
                                              const Machine& machine, gcode::PathMode path,
                                              ChainEnd end, WithPositions places);

// The pieces that have a length, each with a feed above 0. Throws as cutting_time does.
[[nodiscard]] std::vector<TimedPiece> with_length_and_feed(std::span<const TimedPiece> pieces,
                                                           const Machine& machine);

// That of the machine's model. Throws as cutting_time does.
[[nodiscard]] StretchChain stretches_of(std::span<const TimedPiece> pieces, const Machine& machine,
                                        gcode::PathMode path, ChainEnd end, WithPositions places);

}  // namespace batten::postproc
