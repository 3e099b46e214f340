// What a line of Heidenhain Klartext is, by its parts and its first words. Facts:
// docs/controllers/heidenhain.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// `/12 L X+10 ~ ; text`
struct KlartextParts {
  SourceSpan number;       // the block number; empty: none
  SourceSpan content;      // without number, comment, ~ and blanks around it
  SourceSpan comment;      // from ; or from the * of a structure block on; empty: none
  bool skipped = false;    // hidden by a /
  bool continues = false;  // ends with ~: the next line belongs to it
};

// `line` is a span of `text`, without its line end.
[[nodiscard]] KlartextParts klartext_parts(std::string_view text, SourceSpan line);

enum class KlartextKind : std::uint8_t {
  kNothing,     // no content
  kLine,        // L
  kCentre,      // CC
  kArc,         // C
  kRadiusArc,   // CR
  kFunctions,   // M3 M8
  kSpline,      // SPL
  kTangential,  // RND, CHF, CT, DEP, FK ..: the element before it gives the direction or is cut
  kPolar,       // LP, CP: about the CC before it
  kOtherPath,   // LN, APPR, a positioning block (X+50 R+) ..
  kBegin,       // BEGIN PGM name MM
  kEnd,         // END PGM
  kToolCall,
  kCycleDef,
  kCycleCall,
  kDefinition,    // BLK FORM, TOOL DEF, PATTERN DEF, SEL ..: nothing moves, no mode changes
  kAssignment,    // Q1 = .., FN 0 to FN 8, FN 13, FN 18
  kJump,          // FN 9 to FN 12: IF .. GOTO LBL
  kLabel,         // LBL 1, LBL 0
  kCallLabel,     // CALL LBL 1, CALL LBL 1 REP 5
  kCallProgram,   // CALL PGM
  kPlane,         // PLANE ..
  kFunctionTcpm,  // FUNCTION TCPM, FUNCTION RESET TCPM
  kStop,
  kProbe,  // TCH PROBE
  kUnknown,
};

// Of KlartextParts::content; either case.
[[nodiscard]] KlartextKind klartext_kind(std::string_view content);

// K3X-4.7 ..: a line that goes on with a spline, with or without ~ before it.
[[nodiscard]] bool is_coefficient_line(std::string_view content);

// Reads the words of a statement one after the other: letters, or anything else between blanks.
class KlartextTokens {
 public:
  explicit KlartextTokens(std::string_view content) : rest_(content) {}

  // Up to the next blank; empty at the end.
  [[nodiscard]] std::string_view next();

  // What next() would give.
  [[nodiscard]] std::string_view peek() const;

 private:
  std::string_view rest_;
};

// Reads a statement by letters and numbers, whatever the blanks between its words.
class KlartextScanner {
 public:
  KlartextScanner(std::string_view text, SourceSpan content)
      : text_(text.substr(0, content.end)), at_(content.begin) {}

  // Goes behind blanks.
  [[nodiscard]] bool at_end();
  [[nodiscard]] std::uint32_t position() const { return at_; }
  [[nodiscard]] char peek() const { return char_at(text_, at_); }
  void skip() { ++at_; }

  // Capital letters from here on.
  std::string letters();
  // The digits from here on: how many.
  std::uint32_t skip_digits();
  // +1,5 -2. and so on, below kNumberLimit. Stays where nothing is read.
  std::optional<ReadNumber> number();

 private:
  std::string_view text_;
  std::uint32_t at_;
};

}  // namespace batten::gcode
