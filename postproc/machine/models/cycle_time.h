// How long a chain of pieces takes on a machine, by a model of its control.
// Method: docs/algorithms/cycle_time.md.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "gcode/state/modal_state.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/timed_piece.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {

// What follows the chain. It matters on LinuxCNC alone, which brakes with half the
// acceleration where it blends and no more motion comes.
enum class ChainEnd {
  kStop,         // a rapid or another block that ends in a stop
  kEndOfMotion,  // the program's last motion
};

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
  // s: what bends of curves take longer than their feed, under a limit on jerk. There the stretches
  // may be a third too slow (takes_a_plan).
  double in_slow_curves = 0;
};

enum class WithPositions { kNo, kYes };

[[nodiscard]] StretchChain look_ahead_stretches(std::span<const TimedPiece> pieces,
                                                const Machine& machine,
                                                const gcode::PathControl& path,
                                                WithPositions places);

[[nodiscard]] StretchChain grbl_stretches(std::span<const TimedPiece> pieces,
                                          const Machine& machine, const gcode::PathControl& path,
                                          WithPositions places);

[[nodiscard]] StretchChain klipper_stretches(std::span<const TimedPiece> pieces,
                                             const Machine& machine, const gcode::PathControl& path,
                                             WithPositions places);

[[nodiscard]] StretchChain linuxcnc_stretches(std::span<const TimedPiece> pieces,
                                              const Machine& machine,
                                              const gcode::PathControl& path, ChainEnd end,
                                              WithPositions places);

// Seconds from rest to rest. `path` says whether the control blends or keeps the exact path.
// Pieces without length take no time. Linear cost.
//
// Throws std::invalid_argument when a limit of the machine that its model needs is not
// above 0, or a feed is negative or not a number.
[[nodiscard]] double cutting_time(std::span<const TimedPiece> pieces, const Machine& machine,
                                  const gcode::PathControl& path, ChainEnd end = ChainEnd::kStop);

// Whether slow bends of curves are more than a hundredth of the `time` (s) of the chain: then the
// least-time plan (planned_chain.h) tells its time, with kQuickPlanDensity.
[[nodiscard]] bool takes_a_plan(const StretchChain& chain, double time);

// Which chains are worth the work of a plan, some 0.1 ms a piece.
struct WorthAPlan {
  double seconds = 0;  // of slow bends for each piece, at least
};

// Of the many forms that are compared; and no chain at all.
inline constexpr WorthAPlan kAmongForms = {.seconds = 0.005};
inline constexpr WorthAPlan kNoPlan = {.seconds = std::numeric_limits<double>::infinity()};

// The time of one chain of pieces under several settings of its control: what they have in common
// is done once.
class TimedChain {
 public:
  // With every feed so many times the programmed one. Throws as cutting_time does. `machine` must
  // live as long.
  TimedChain(std::span<const TimedPiece> pieces, const Machine& machine, double feed_override = 1);

  // As cutting_time. Where no plan is worth it, it is the time of the stretches, whose slow bends
  // are too slow.
  [[nodiscard]] double time(const gcode::PathControl& path, ChainEnd end = ChainEnd::kStop,
                            WorthAPlan worth = {}) const;

 private:
  const Machine& machine_;
  std::vector<TimedPiece> moving_;
};

// The pieces that have a length, each with a feed above 0. Throws as cutting_time does.
[[nodiscard]] std::vector<TimedPiece> with_length_and_feed(std::span<const TimedPiece> pieces,
                                                           const Machine& machine,
                                                           double feed_override = 1);

// The chain as the machine's model has it. Throws as cutting_time does.
[[nodiscard]] StretchChain stretches_of(std::span<const TimedPiece> pieces, const Machine& machine,
                                        const gcode::PathControl& path, ChainEnd end,
                                        WithPositions places);

}  // namespace batten::postproc
