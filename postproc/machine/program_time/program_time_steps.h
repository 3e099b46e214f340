// A program as what a machine does in time: motions with their feeds, waits, and a list of what
// cannot be told from the text. No machine is asked here.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/path/path.h"
#include "postproc/machine/program_time/program_time_blocks.h"
#include "postproc/machine/program_time/program_time_not_timed.h"

namespace batten::postproc {

// How joints of motions are passed: what G61, G61.1 and G64 P Q say.
struct PathControl {
  gcode::PathMode mode = gcode::PathMode::kUnknown;  // kUnknown: the program has not said
  std::optional<double> blend_tolerance;             // mm, P; set by every G64 (0: without P)
  std::optional<double> naive_cam_tolerance;         // mm, Q
  bool operator==(const PathControl&) const = default;
};

struct ProgramStep {
  StepKind kind = StepKind::kRest;
  bool stops_after = false;     // G9: exact stop of this block
  std::uint16_t control = 0;    // index into ProgramSteps::controls
  std::int32_t tool = kNoTool;  // number of the tool in the spindle
  std::uint32_t block = 0;      // index into Program::blocks
  double feed = 0;              // kCut: mm/min; 0: not known
  double seconds = 0;           // kDwell, kRotary
  geometry::PathPiece piece;    // kCut, kRapid: absolute mm

  static constexpr std::int32_t kNoTool = -1;
};

struct StepOptions {
  gcode::DwellUnit dwell_unit = gcode::DwellUnit::kByPoint;
  std::optional<geometry::Point3> start;  // mm: where the tool stands before the program
};

struct ProgramSteps {
  std::vector<ProgramStep> steps;
  std::vector<PathControl> controls;  // [0]: the program has said nothing
  NotTimedList not_timed;
};

// The steps up to the end of the program (M2, M30). Loops and subprograms are not followed;
// what stands in them counts once. Canned cycles of drilling along Z are followed
// (program_time_blocks.h). Linear cost.
//
// Where the interpreter does not know where a motion starts, the last programmed place is
// taken (tools, offsets and M functions leave it where it was) and that is counted; axes that
// have no such place take no time.
[[nodiscard]] ProgramSteps read_steps(const gcode::Program& program,
                                      const gcode::Interpretation& meaning,
                                      const StepOptions& options);

}  // namespace batten::postproc
