// What the words of one block do in time: how long a G4 waits, and the moves that controls make of
// canned cycles of drilling along Z (G73, G81 to G86 and G89 in the plane XY).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

enum class StepKind : std::uint8_t {
  kCut,         // at a feed
  kRapid,       // G0
  kDwell,       // G4, or at the bottom of a drilled hole
  kToolChange,  // M6
  kSpindle,     // M3, M4: the spindle has to reach its speed
  kRotary,      // only rotary axes turn, for a time that the program says (G93)
  kRest,        // motion ends before the block goes on (M7, S, G54 ..); no time of its own
};

// --- dwells ------------------------------------------------------------------------------------

// How long a G4 waits.
struct DwellTime {
  std::optional<double> seconds;  // nothing: the block does not say, or in turns of a spindle
                                  // whose speed is not known
  bool unit_assumed = false;      // P without a point, where no control was named
};

// X, U: seconds (FANUC). F: seconds, S: turns of the spindle (Sinumerik). P: by `unit`.
[[nodiscard]] DwellTime dwell_of(const gcode::BlockWords& words, gcode::DwellUnit unit,
                                 std::optional<double> spindle_speed);

// What P means in the programs of a control; nullptr: LinuxCNC and grbl count in seconds, Klipper
// in milliseconds, whatever the program was written for.
[[nodiscard]] gcode::DwellUnit dwell_unit_of(const gcode::Control* target, const Machine& machine);

// --- canned cycles -----------------------------------------------------------------------------

struct CycleMove {
  StepKind kind = StepKind::kCut;  // kCut, kRapid, kDwell, kSpindle
  geometry::Line line;             // kCut, kRapid; may have no length
  double seconds = 0;              // kDwell
};

// The words of a cycle that stay for its later holes, in mm as programmed.
class DrillingCycle {
 public:
  DrillingCycle(const gcode::CodeRow& row, double initial_z) : row_(&row), initial_z_(initial_z) {}

  // `dwell` is what the P of this block means in seconds, where it is there.
  void read(const gcode::BlockWords& words, const gcode::ModalState& state,
            std::optional<double> dwell);
  // G98: back to the height at the start of the cycle; G99: to R.
  void set_return_to_initial(bool initial) { returns_to_initial_ = initial; }
  void change(const gcode::CodeRow& row) { row_ = &row; }

  // The moves of one block from `from`: L (or K) times the hole. Nothing where Z or R was never
  // given, a peck has no depth, or the bottom is not below R.
  [[nodiscard]] std::optional<std::vector<CycleMove>> moves(const gcode::BlockWords& words,
                                                            const gcode::ModalState& state,
                                                            const geometry::Point3& from) const;

 private:
  const gcode::CodeRow* row_;  // of the table
  double initial_z_;
  bool returns_to_initial_ = true;
  std::optional<double> z_;
  std::optional<double> r_;
  std::optional<double> peck_;
  double dwell_ = 0;  // s
};

// Where the tool is as far as a program's text says, axis by axis.

enum class Certainty : std::uint8_t {
  kUnknown,  // never said
  kAssumed,  // as last programmed, but a tool change or an offset came since
  kKnown,
};

class ToolPlace {
 public:
  void set(const geometry::Point3& mm);
  void set_axis(std::size_t axis, double mm, Certainty certainty);
  void forget_axis(std::size_t axis) { certainty_[axis] = Certainty::kUnknown; }
  void forget() { certainty_.fill(Certainty::kUnknown); }
  // From now on it is an assumption that the tool still is there.
  void doubt();

  [[nodiscard]] const geometry::Point3& mm() const { return mm_; }
  [[nodiscard]] Certainty certainty(std::size_t axis) const { return certainty_[axis]; }
  [[nodiscard]] bool is_known() const {  // or assumed, on every axis
    return std::ranges::find(certainty_, Certainty::kUnknown) == certainty_.end();
  }

 private:
  geometry::Point3 mm_ = geometry::Point3::Zero();
  std::array<Certainty, 3> certainty_ = {Certainty::kUnknown, Certainty::kUnknown,
                                         Certainty::kUnknown};
};

// A motion with its place as sure as it can be.
struct PlacedMotion {
  geometry::PathPiece piece;
  Certainty start = Certainty::kKnown;  // the least over the axes that move
};

// A straight motion along the axis words of a block, in a state of known units.
[[nodiscard]] PlacedMotion line_of_words(const gcode::BlockWords& words,
                                         const gcode::ModalState& state, const ToolPlace& place);

// The interpreter's motion; what it does not know of the start comes from `place`.
[[nodiscard]] PlacedMotion place_motion(const gcode::Motion& motion, const gcode::BlockWords& words,
                                        const gcode::ModalState& state, const ToolPlace& place);

// The tool is at the end of the motion: axes that the block names are known, unless the start
// of an increment was not.
void move_to_end(ToolPlace& place, const PlacedMotion& motion, const gcode::BlockWords& words,
                 const gcode::ModalState& state);

}  // namespace batten::postproc
