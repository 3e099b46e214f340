// The text that says the acts of a program in another language.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/dialect.h"
#include "gcode/motion.h"
#include "gcode/program.h"
#include "postproc/translation/obstacles.h"
#include "postproc/translation/program_acts.h"

namespace batten::postproc {

struct TranslationSource {
  const gcode::Program& program;  // in Language::kRs274
  const gcode::Interpretation& meaning;
  const ProgramActs& acts;
  // --allow work-offset: where the language has no word for G54, the datum that is active on the
  // control stands for it.
  bool datum_is_work_offset = false;
  // --allow tool-length: where lengths always count, they may count behind G49, too.
  bool length_counts_always = false;
};

struct Translation {
  std::string text;
  std::vector<std::uint32_t>
      source_lines;                 // for each line of `text`, the line of the source, from 1
  double rounding_mm = 0;           // how far a printed place is from the source's, at most
  std::vector<Obstacle> obstacles;  // what the language cannot say; then the text is worth nothing
};

// Heidenhain Klartext in millimetres, without block numbers, under this program name:
//   G0 X1 Y2      L X+1 Y+2 FMAX
//   G1 X1 F500    L X+1 F500
//   G2, G3        CC X+0 Y+0 and C X+1 Y+2 DR-
//   T5 M6, S3000  TOOL CALL 5 Z S3000
//   (text)        ; text
// The unit is always the millimetre: what F means in an INCH program is not the same on all of
// these controls. Obstacles: arcs out of the plane of X and Y, helices, arcs whose radii differ by
// more than the control takes, places beyond its range, work offsets and motions
// behind G49 that are not allowed.
[[nodiscard]] Translation in_klartext(const TranslationSource& source, const gcode::Dialect& target,
                                      std::string_view name);

// Siemens words: those of the source, with a `%_N_name_MPF` before them and comments as `; text`.
// Obstacles: helices, G43, G49, G58 and G59, and lines longer than the target takes.
[[nodiscard]] Translation in_siemens(const TranslationSource& source, const gcode::Dialect& target,
                                     std::string_view name);

// A name that either control takes, from that of a file: capitals, digits and _.
[[nodiscard]] std::string program_name(std::string_view file);

// What Klartext says in place of a work offset, so that the proof finds it and the operator sees
// it: "G54: its datum is active".
[[nodiscard]] std::string datum_remark(int work_offset);

// The same for motions behind G49.
inline constexpr std::string_view kLengthRemark = "G49: the length of the tool counts";

}  // namespace batten::postproc
