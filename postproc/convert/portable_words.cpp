#include "postproc/convert/portable_words.h"

#include <algorithm>
#include <array>

#include "gcode/state/code_table.h"

namespace batten::postproc {
namespace {

using gcode::Language;
using gcode::Word;

// M3 and M4, each with M8.
constexpr std::array kKlartextFunctions = {130, 140};
constexpr std::string_view kCertainLetters = "NGMXYZIJKRFSTH";

}  // namespace

bool names_work_offset(int code) {
  const gcode::CodeRow& row = gcode::row_of_g(code);
  return row.group == gcode::CodeGroup::kWorkOffset && row.is(gcode::trait::kCommon);
}

bool is_certain_function(int code, Language language) {
  return gcode::row_of_m(code).is(gcode::trait::kCommon) ||
         (language == Language::kKlartext &&
          std::ranges::find(kKlartextFunctions, code) != kKlartextFunctions.end());
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
    return word.letter == letter && gcode::code_of(word) == code;
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
