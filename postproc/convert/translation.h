// The text that says the acts of a program in another language.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/motion.h"
#include "gcode/text/number_format.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "postproc/convert/conversion.h"
#include "postproc/convert/program_operations.h"

namespace batten::postproc {

struct TranslationSource {
  const gcode::Program& program;  // in any language
  const gcode::Interpretation& meaning;
  const ProgramOperations& operations;
  // --allow work-offset: where the language has no word for G54, the datum that is active on the
  // control stands for it.
  bool datum_is_work_offset = false;
  // --allow tool-length: where lengths always count, they may count after G49, too.
  bool length_counts_always = false;
  // --allow blank-form: BLK FORM may become a comment.
  bool blank_is_remark = false;
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
// more than the control takes, places beyond its range, work offsets and motions without the length
// of the tool that are not allowed.
[[nodiscard]] Translation in_klartext(const TranslationSource& source, const gcode::Control& target,
                                      std::string_view name);

// Plain words (RS-274) or Siemens words, by the target's language, in the units of the program:
//   L X+1 Y+2 FMAX        G0 X1 Y2
//   L X+1 F500            G1 X1 F500
//   CC, C, CR             G2 or G3 with I J K, or R where the target has that
//   TOOL CALL 5 Z S3000   T5 M6, G43 H5 (Siemens: D1), S3000
//   ; text                a comment of the target
// First the modes are said that the language of the program implies: G21 (Siemens: G710), G17, G40,
// G90, G94. The file has the frame that controls of the FANUC kind want (%, O0001, %); its O number
// is `name`, where that is a number of up to four digits, else 1. Arcs are cut where the target
// takes only shorter ones; one that is too small for it is chords that leave it by a printed step
// at the most.
//
// Obstacles: words that the target refuses or takes for something else, arcs that it does not take,
// helices where it has none, G58 and G59 for Siemens, where the length of the tool is not said in a
// Siemens program, lines longer than the target takes; for plain words a program without an end.
[[nodiscard]] Translation in_plain_words(const TranslationSource& source,
                                         const gcode::Control& target, std::string_view name);

// A name that either control takes, from that of a file: capitals, digits and _.
[[nodiscard]] std::string program_name(std::string_view file);

// The lines of a translation as they come.
class TranslationText {
 public:
  // `source_line`: from 1.
  void add(std::string_view line, std::uint32_t source_line) {
    result_.text += line;
    result_.text += '\n';
    result_.source_lines.push_back(source_line);
  }

  // "; text", in as many lines as its length takes; characters that are no plain text become ?.
  void add_comment(std::string_view text, std::uint32_t source_line, std::size_t longest);

  void refuse(gcode::SourceSpan where, std::string why) {
    result_.obstacles.push_back({where, std::move(why)});
  }

  // A comment of the target, in as many lines as its length takes; characters that its comments
  // cannot have become -. False where it has no comments, and none for an empty text.
  [[nodiscard]] bool add_comment_of(const gcode::Control& target, std::string_view text,
                                    std::uint32_t source_line);

  // The digits of a place, whose rounding is remembered. `unit`: mm.
  [[nodiscard]] std::string place(double mm, int axis, const gcode::NumberFormat& format,
                                  double unit = 1);

  // What is off by as much beside that, mm on each axis.
  void add_rounding(double mm) { beside_ = std::max(beside_, mm); }

  [[nodiscard]] Translation take();

 private:
  Translation result_;
  geometry::Point3 rounding_ = geometry::Point3::Zero();  // greatest on each axis, mm
  double beside_ = 0;                                     // mm
};

}  // namespace batten::postproc
