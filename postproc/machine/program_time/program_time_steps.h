// A program as what a machine does in time: motions with their feeds, waits, and a list of what
// cannot be told from the text. No machine is asked here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/path/path.h"
#include "postproc/machine/program_time/program_time_blocks.h"

namespace batten::postproc {

// Ids besides the reasons of gcode/state/reason.h, some of which count here too.
namespace not_timed {
inline constexpr std::string_view kPlaceUnknown = "start-unknown";
inline constexpr std::string_view kPlaceAssumed = "position-assumed";
inline constexpr std::string_view kRotaryAxis = "rotary-axis";
inline constexpr std::string_view kPathChanged = "path-changed-by-control";
inline constexpr std::string_view kSpindleUnknown = "spindle-speed-unknown";
inline constexpr std::string_view kDwellUnknown = "dwell-unknown";
inline constexpr std::string_view kDwellAssumed = "dwell-unit-assumed";
inline constexpr std::string_view kReferenceMove = "reference-move";
inline constexpr std::string_view kOperatorStop = "operator-stop";
inline constexpr std::string_view kAfterEnd = "after-end";
}  // namespace not_timed

struct NotTimed {
  std::string_view id;  // stable: "start-unknown"
  std::string_view text;
  std::size_t count = 0;
  std::uint32_t first_line = 0;
};

class NotTimedList {
 public:
  // Once more; the first call of an id says its line.
  void add(std::string_view id, std::uint32_t line);
  [[nodiscard]] const std::vector<NotTimed>& entries() const { return entries_; }

 private:
  std::vector<NotTimed> entries_;
};

struct ProgramStep {
  StepKind kind = StepKind::kRest;
  bool stops_after = false;     // G9: exact stop of this block
  bool says_speed = false;      // of the spindle, the one that holds: see TimedPiece
  bool goes_on = false;         // of the block of the step before it: see TimedPiece
  float arcs = 0;               // of a piece of a curve: see TimedPiece
  std::uint16_t control = 0;    // index into ProgramSteps::controls
  std::int32_t tool = kNoTool;  // number of the tool in the spindle
  std::uint32_t line = 0;       // of its block
  std::uint32_t bytes = 0;      // of the blocks since the step before it, its own with them
  double feed = 0;              // kCut: mm/min; kRapid: the last one; 0: not known
  double seconds = 0;           // kDwell, kRotary
  geometry::PathPiece piece;    // kCut, kRapid: absolute mm

  static constexpr std::int32_t kNoTool = -1;
};

struct StepOptions {
  gcode::DwellUnit dwell_unit = gcode::DwellUnit::kByPoint;
  std::optional<geometry::Point3> start = {};  // mm: where the tool is before the program
  double feed_override = 1;         // all feeds are so many times the programmed ones; rapids stay
  std::optional<bool> has_m6 = {};  // changes the tools; nothing: the text that is read says it
};

struct ProgramSteps {
  std::vector<ProgramStep> steps;
  std::vector<gcode::PathControl> controls;  // [0]: the program has said nothing: kUnknown
  NotTimedList not_timed;
};

// The steps up to the end of the program (M2, M30). Loops and subprograms are not followed;
// what is in them counts once. Canned cycles of drilling along Z are followed
// (program_time_blocks.h). Linear cost.
//
// Where the interpreter does not know where a motion starts, the last programmed place is
// taken (tools, offsets and M functions leave it where it was) and that is counted; axes that
// have no such place take no time.
[[nodiscard]] ProgramSteps read_steps(const gcode::Program& program,
                                      const gcode::Interpretation& meaning,
                                      const StepOptions& options);

// The same for a program that is read part by part, of which StepOptions must say has_m6: gives the
// steps of the blocks from `first` to before `end`, and the controls and what is not timed so far.
using StepReader = std::function<const ProgramSteps&(const gcode::Program& part,
                                                     const gcode::Interpretation& meaning,
                                                     std::size_t first, std::size_t end)>;
[[nodiscard]] StepReader step_reader(const StepOptions& options);
[[nodiscard]] bool has_m6(const gcode::Program& program);

}  // namespace batten::postproc
