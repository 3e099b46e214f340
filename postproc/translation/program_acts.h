// What a program of plain words (RS-274) does, act by act, so that it can be said in another
// language. Only what every control that reads such words does for certain is an act; all else is
// an obstacle.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/motion.h"
#include "gcode/program.h"
#include "postproc/translation/obstacles.h"

namespace batten::postproc {

enum class ActKind : std::uint8_t {
  kComment,     // `text`, without its brackets
  kWorkOffset,  // `number`: 54 to 59; before all motions, each time the same
  kNoLength,    // G49: what moves next does so without the length of the tool
  kTool,        // `number` is put into the spindle; its length counts from here on
  kSpeed,       // of the spindle: `number`, another one than before
  kFunction,    // M `number`: 3, 4, 5, 8, 9, 0, 1
  kMotion,      // `motion` at `feed`: a rapid, a line, an arc; what it needs is known
  kEnd,         // M `number`: 2 or 30; nothing follows
};

struct Act {
  ActKind kind = ActKind::kComment;
  std::uint32_t block = 0;
  gcode::SourceSpan where;  // the word, or the block
  std::string_view text;
  double number = 0;
  std::int32_t motion = -1;    // index into Interpretation::motions
  std::optional<double> feed;  // mm/min; of lines and arcs
};

struct ProgramActs {
  std::vector<Act> acts;            // in the order in which the control does them
  std::vector<Obstacle> obstacles;  // at most one for each block
};

// In a block: tool, speed, spindle, coolant, work offset, motion, stop, end. M3, M4 and M8 beside a
// motion come before it.
//
// Obstacles are, besides words and blocks that are not plain: increments; compensation and other
// states in which the words are not the path; M5, M9 and stops beside a motion, where controls
// differ in what comes first; M0 and M1 with spindle or coolant on, which some controls stop then;
// T without M6, which changes the tool on some controls; G43 but for the length of the tool that
// was just put in; G64 with a tolerance; dwells, whose
// number is seconds or milliseconds.
//
// `program` was read in Language::kRs274. Views into its text.
[[nodiscard]] ProgramActs acts_of(const gcode::Program& program,
                                  const gcode::Interpretation& meaning);

}  // namespace batten::postproc
