// Words that a user's profile adds to a written program: the control's own smoothing around
// rewritten runs, a header, a footer. Whole lines; {tolerance} stands for the tolerance in the
// program's units. What they do on the control is not known here: they may set how fast and how
// smoothly it runs, never where.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/text/program.h"

namespace batten::postproc {

struct ProfileWords {
  std::vector<std::string> header;      // before the program's first block that says anything
  std::vector<std::string> footer;      // before its end (M2, M30, the last %)
  std::vector<std::string> before_run;  // before each rewritten run, or chain of them
  std::vector<std::string> after_run;   // after it
  [[nodiscard]] bool empty() const;
  bool operator==(const ProfileWords&) const = default;
};

// Why a line may not stand in a profile, with what may; empty when it may:
//   - comments as the target writes them;
//   - G5.1 Q.., G5 P.., G5.3 P.., G5.4 Q.., G8 P.., G61.1, G64 (P Q), G130, G131, G187 (P E),
//     G641 to G645, and M words from M100 on, without M128, M129 and M198; axis words only as X0 Y0
//     Z0 after G5.1;
//   - CYCLE832(..), COMPON, COMPCAD, COMPCURV, COMPSURF, COMPOF, SOFT, BRISK, FFWON, FFWOF,
//   CTOL=..,
//     OTOL=..;
//   - CYCL DEF 32..;  #HSC ON.., #HSC OFF.
[[nodiscard]] std::string why_not_in_profile(const std::string& line, const gcode::Control& target);

// All that is wrong with the words together: a line before runs without one after them, and so on.
[[nodiscard]] std::vector<std::string> problems_of(const ProfileWords& words);

// Does the line act on the control? A comment does not.
[[nodiscard]] bool acts(std::string_view line);

// What a program must not have itself: a G or M code (in tenths), or a name of another language.
struct SettingKey {
  char letter = 0;
  int code = 0;
  std::string name;  // upper case; empty where a code counts
};
[[nodiscard]] std::vector<SettingKey> setting_keys(const ProfileWords& words);

// With the tolerance put in, printed with up to six decimals in these units.
[[nodiscard]] ProfileWords filled_in(const ProfileWords& words, double tolerance_mm,
                                     gcode::Units units, const gcode::Control& target);

}  // namespace batten::postproc
