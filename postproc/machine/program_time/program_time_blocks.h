// What the words of one block do in time: how long a G4 waits, and the moves that controls make of
// canned cycles of drilling along Z (G73, G81 to G86 and G89 in the plane XY).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/control/dialect.h"
#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"
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

// What P means in the programs of a control; nullptr: LinuxCNC and grbl count in seconds, whatever
// the program was written for.
[[nodiscard]] gcode::DwellUnit dwell_unit_of(const gcode::Dialect* target, const Machine& machine);

// --- canned cycles -----------------------------------------------------------------------------

[[nodiscard]] bool is_drilling_cycle(gcode::Code code);

struct CycleMove {
  StepKind kind = StepKind::kCut;  // kCut, kRapid, kDwell, kSpindle
  geometry::Line line;             // kCut, kRapid; may have no length
  double seconds = 0;              // kDwell
};

// The words of a cycle that stay for its later holes, in mm as programmed.
class DrillingCycle {
 public:
  explicit DrillingCycle(gcode::Code code, double initial_z) : code_(code), initial_z_(initial_z) {}

  [[nodiscard]] gcode::Code code() const { return code_; }

  // `dwell` is what the P of this block means in seconds, where it stands.
  void read(const gcode::BlockWords& words, const gcode::ModalState& state,
            std::optional<double> dwell);
  // G98: back to the height at the start of the cycle; G99: to R.
  void set_return_to_initial(bool initial) { returns_to_initial_ = initial; }
  void change_code(gcode::Code code) { code_ = code; }

  // The moves of one block from `from`: L (or K) times the hole. Nothing where Z or R was never
  // given, a peck has no depth, or the bottom is not below R.
  [[nodiscard]] std::optional<std::vector<CycleMove>> moves(const gcode::BlockWords& words,
                                                            const gcode::ModalState& state,
                                                            const geometry::Point3& from) const;

 private:
  gcode::Code code_;
  double initial_z_;
  bool returns_to_initial_ = true;
  std::optional<double> z_;
  std::optional<double> r_;
  std::optional<double> peck_;
  double dwell_ = 0;  // s
};

}  // namespace batten::postproc
