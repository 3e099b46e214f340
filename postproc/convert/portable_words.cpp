#include "postproc/convert/portable_words.h"

#include <algorithm>
#include <array>

#include "postproc/options/profile_words.h"

namespace batten::postproc {
namespace {

using gcode::Language;
using gcode::Word;

constexpr std::array kSilentCodes = {0,   10,  20,  30,  170, 180, 190, 200, 210, 400, 700,
                                     710, 800, 900, 901, 910, 911, 940, 970, 980, 990};
constexpr std::array kCertainFunctions = {0, 10, 20, 30, 40, 50, 60, 80, 90, 300};
// M3 and M4, each with M8.
constexpr std::array kKlartextFunctions = {130, 140};
constexpr std::string_view kCertainLetters = "NGMXYZIJKRFSTH";

template <std::size_t count>
bool holds(const std::array<int, count>& codes, int code) {
  return std::ranges::find(codes, code) != codes.end();
}

}  // namespace

bool is_silent_code(int code) { return holds(kSilentCodes, code); }

bool names_work_offset(int code) { return code >= 540 && code <= 590 && code % 10 == 0; }

bool is_certain_function(int code, Language language) {
  return holds(kCertainFunctions, code) ||
         (language == Language::kKlartext && holds(kKlartextFunctions, code));
}

bool is_certain_letter(char letter, Language language) {
  return kCertainLetters.find(letter) != std::string_view::npos ||
         (language == Language::kSiemens && letter == 'D');
}

bool is_arc_letter(char letter) {
  return std::string_view("IJKR").find(letter) != std::string_view::npos;
}

bool is_place_letter(char letter) {
  return is_arc_letter(letter) || (letter >= 'X' && letter <= 'Z');
}

const Word* first_word(std::span<const Word> words, char letter) {
  const auto found = std::ranges::find(words, letter, &Word::letter);
  return found == words.end() ? nullptr : &*found;
}

const Word* coded_word(std::span<const Word> words, char letter, int code) {
  const auto found = std::ranges::find_if(words, [&](const Word& word) {
    return word.letter == letter && word.is_number && tenths_of(word) == code;
  });
  return found == words.end() ? nullptr : &*found;
}

std::string_view why_no_plain_block(const gcode::Block& block, const gcode::BlockMeaning& meaning) {
  if (block.block_delete) return "is left out by some controls, run by others";
  if (block.has_checksum) return "has a check sum";
  const bool named = block.opacity == gcode::ParseStatus::kNamedWords;
  if (block.opacity != gcode::ParseStatus::kNone && !named) return "is no block of plain words";
  if (meaning.label_referenced || meaning.entered_from_elsewhere) return "is jumped to";
  if (meaning.kind == gcode::BlockKind::kOpaque && !named) return "is not understood";
  return {};
}

std::string_view why_no_certain_dwell(std::span<const Word> words, gcode::DwellForm form) {
  if (form == gcode::DwellForm::kSecondsF && first_word(words, 'S') != nullptr) {
    return "waits for turns of the spindle, which is no time";
  }
  if (form == gcode::DwellForm::kUnknown && first_word(words, 'P') != nullptr) {
    return "waits for seconds on some controls and for milliseconds on others; --source ngc, grbl, "
           "fanuc or haas says which";
  }
  return "waits for a time that is not certain";
}

std::string_view text_of_comment(std::string_view comment) {
  if (comment.starts_with('(')) {
    comment.remove_prefix(1);
    if (comment.ends_with(')')) comment.remove_suffix(1);
  } else if (comment.starts_with(';') || comment.starts_with('*')) {
    comment.remove_prefix(1);
  }
  while (comment.starts_with(' ')) comment.remove_prefix(1);
  while (comment.ends_with(' ')) comment.remove_suffix(1);
  return comment;
}

}  // namespace batten::postproc
