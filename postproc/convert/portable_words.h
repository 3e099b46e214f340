// Which words of a block mean the same on every control of their language, as far as the word
// itself says it.
#pragma once

#include <span>
#include <string_view>

#include "gcode/state/motion.h"
#include "gcode/text/language.h"
#include "gcode/text/program.h"

namespace batten::postproc {

// In tenths.
namespace word_code {
inline constexpr int kToolLengthOn = 430;
inline constexpr int kToolLengthOff = 490;
inline constexpr int kBlending = 640;
inline constexpr int kToolChange = 60;
inline constexpr int kDwell = 40;
}  // namespace word_code

// G54 to G59.
[[nodiscard]] bool names_work_offset(int code);

// M0 to M6, M8, M9, M30; in Klartext M13 and M14, too.
[[nodiscard]] bool is_certain_function(int code, gcode::Language language);

// Whether words of this letter can be certain at all.
[[nodiscard]] bool is_certain_letter(char letter, gcode::Language language);

[[nodiscard]] bool is_place_letter(char letter);  // X Y Z I J K R
[[nodiscard]] bool is_arc_letter(char letter);    // I J K R

// The first word of this letter, or of this letter and code; nullptr where there is none.
[[nodiscard]] const gcode::Word* first_word(std::span<const gcode::Word> words, char letter);
[[nodiscard]] const gcode::Word* coded_word(std::span<const gcode::Word> words, char letter,
                                            int code);

// Why the block as a whole cannot be said; empty where its words are to be looked at. A Siemens
// block of named words counts as plain here.
[[nodiscard]] std::string_view why_no_plain_block(const gcode::Block& block,
                                                  const gcode::BlockMeaning& meaning);

// Why a block with G4 is no dwell of a certain time; gcode::dwell_ms says nothing of it.
[[nodiscard]] std::string_view why_no_certain_dwell(std::span<const gcode::Word> words,
                                                    gcode::DwellForm form);

// The text of a comment without its brackets, or what it begins with.
[[nodiscard]] std::string_view text_of_comment(std::string_view comment);

}  // namespace batten::postproc
