// Programs that were made for another family of controls than the target's.
//
// Within RS-274 nothing is translated: what is not rewritten is copied, so a program can go to
// another control only when every block that is copied says the same there. Between plain words,
// Klartext and Siemens it is translated first (postproc/stream/pipeline.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/reading/parser.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/language.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"

namespace batten::postproc {

// The language to read the program in (gcode/reading/source_kind.h). Nothing, and an error, where
// that is not certain; and an error "foreign-language" where the target reads another one. Plain
// words (RS-274) are read for Siemens targets too.
[[nodiscard]] std::optional<gcode::Language> language_read(const gcode::SourceText& source,
                                                           const SmoothOptions& options,
                                                           gcode::Diagnostics& found);

// The language of a program that may be for another control than the target. A text without marks
// counts as plain words (RS-274) here, unless the target is one for Siemens words and the text has
// such names. Nothing where it is not certain.
[[nodiscard]] std::optional<gcode::Language> language_before_target(const gcode::SourceText& source,
                                                                    gcode::SourceKind kind,
                                                                    gcode::Language target);

// With --convert: the language of the program (language_before_target), where the target reads
// another one. Nothing where nothing is to be translated.
[[nodiscard]] std::optional<gcode::Language> language_to_translate(const gcode::SourceText& source,
                                                                   const SmoothOptions& options);

[[nodiscard]] inline bool is_to_be_translated(const gcode::SourceText& source,
                                              const SmoothOptions& options) {
  return language_to_translate(source, options).has_value();
}

// How a program in this language is read with these options.
[[nodiscard]] gcode::Reading reading_of(const SmoothOptions& options, gcode::Language language);

// Adds an error "other-family" for each kind of words of controls that the target is none of, at
// its first place, and for a dwell that, as its source reads it, waits for another time than the
// target does.
void tell_of_other_family(const gcode::Program& program, const gcode::Control& target,
                          gcode::Diagnostics& found);

// Adds an error "cannot-convert" for each block with a word that the target does not take, or not
// for certain in the same meaning: only words that mean the same on every control of the RS-274
// family pass (motions, planes, units, work offsets G54 to G59, G40, G43 with H, G49, G80, G90,
// G91, G94, M0 to M6, M8, M9, M30, F, S, T, comments in the target's form), without those that the
// target refuses. After 50 blocks one more says how many there are.
void tell_what_cannot_be_said(const gcode::Program& program, const gcode::Control& target,
                              gcode::Diagnostics& found);

// What a program says that its target cannot be told.
struct Obstacle {
  gcode::SourceSpan where;
  std::string why;  // goes on after the text that is there: "is not taken there"
};

// Adds an error "cannot-convert" for each, in their order; after 50 one more says how many there
// are.
void tell_obstacles(const std::vector<Obstacle>& obstacles, const gcode::Program& program,
                    const gcode::Control& target, gcode::Diagnostics& found);

// Why a word is an obstacle that other controls may read otherwise.
inline constexpr std::string_view kOtherThere = "may mean something else there";

// Codes in tenths.
namespace word_code {
inline constexpr int kToolLengthOn = 430;
inline constexpr int kToolLengthOff = 490;
inline constexpr int kBlending = 640;
inline constexpr int kToolChange = 60;
inline constexpr int kDwell = 40;
}  // namespace word_code

// The first word of this letter, and of this code where one is given; nullptr where there is none.
[[nodiscard]] const gcode::Word* find_word(std::span<const gcode::Word> words, char letter,
                                           std::optional<int> code = std::nullopt);

// Why a block with G4 is no dwell of a certain time; gcode::dwell_ms says nothing of it.
[[nodiscard]] std::string_view why_no_certain_dwell(std::span<const gcode::Word> words,
                                                    gcode::DwellForm form);

}  // namespace batten::postproc
