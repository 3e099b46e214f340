// What a program does, act by act, so that it can be said in another language: plain words
// (RS-274), Siemens words and Klartext give the same acts. Only what every control that reads the
// program's language does for certain is an act; all else is an obstacle.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"
#include "postproc/convert/conversion.h"

namespace batten::postproc {

enum class OperationKind : std::uint8_t {
  kComment,       // `text`, without its brackets
  kBlank,         // `text` draws the blank for the control's simulation: BLK FORM
  kBlending,      // corners as the control rounds them: G64 without a tolerance
  kWorkOffset,    // `number`: 54 to 59; before all motions, each time the same
  kNoLength,      // G49: what moves next does so without the length of the tool
  kLengthUnsaid,  // what moves next along Z: nothing says whether the tool's length counts
  kTool,          // `number` is put into the spindle
  kLength,        // from here on the length of that tool counts; nothing has moved along Z since
  kSpeed,         // of the spindle: `number`, another one than before
  kDwell,         // waits for `number` milliseconds
  kFunction,      // M `number`: 3, 4, 5, 8, 9, 0, 1
  kMotion,        // `motion` at `feed`: a rapid, a line, an arc; what it needs is known
  kEnd,           // M `number`: 2 or 30; or 0: END PGM alone; nothing follows
};

// mm: an arc that rises by more is a helix.
inline constexpr double kLevelArc = 1e-9;
[[nodiscard]] inline bool rises(const geometry::Arc& arc) {
  return std::abs(arc.axis.dot(arc.end - arc.start)) > kLevelArc;
}

// Remarks in Klartext for what it has no words for, so that the proof and the operator see it.

inline constexpr std::string_view kLengthRemark = "G49: the length of the tool counts";
// For motions along Z after a tool change without G43.
inline constexpr std::string_view kUnsaidLengthRemark = "no G43: the length of the tool counts";
// What other languages say before their M30, where Klartext ends by its END PGM alone.
inline constexpr std::string_view kEndRemark = "END PGM";
// "G54: its datum is active"
[[nodiscard]] inline std::string datum_remark(int work_offset) {
  return "G" + std::to_string(work_offset) + ": its datum is active";
}

struct Operation {
  OperationKind kind = OperationKind::kComment;
  std::uint32_t block = 0;
  gcode::SourceSpan where;  // the word, or the block
  double number = 0;
  std::string_view text = {};
  std::int32_t motion = -1;         // index into Interpretation::motions
  std::optional<double> feed = {};  // mm/min; of lines and arcs
  [[nodiscard]] int whole() const { return static_cast<int>(number); }
};

struct ProgramOperations {
  std::vector<Operation> operations;  // in the order in which the control does them
  std::vector<Obstacle> obstacles;    // at most one for each block
};

// In a block: dwell alone; or tool, speed, spindle, coolant, work offset, motion, stop, end. M3, M4
// and M8 beside a motion come before it; M5 and M9 of Klartext after it.
//
// The length of the tool: G43 H, D1 (Siemens), or TOOL CALL (Klartext, where it always counts).
// Remarks that a translation left in Klartext are the acts that they stand for.
//
// Obstacles are, besides words and blocks that are not plain: increments; compensation and other
// states in which the words are not the path; M5, M9 and stops beside a motion, where controls
// differ in what comes first; M0 and M1 with spindle or coolant on, which some controls stop then;
// T without M6, which changes the tool on some controls; G43, D but for the length of the tool that
// was just put in; a tool put in with the spindle on, and a cut after it without M3 or M4 between;
// G64 with a tolerance; dwells whose number may be seconds or milliseconds (gcode/state/dwell.h).
// Of Siemens programs, names but G71, G700, G710, and helices; of Klartext programs, whatever is
// not L, CC, C, CR, TOOL CALL, cycle 9, M functions and BLK FORM, and inches: what F means then is
// not certain.
//
// Views into the program's text.
[[nodiscard]] ProgramOperations operations_of(const gcode::Program& program,
                                              const gcode::Interpretation& meaning);

}  // namespace batten::postproc
