#include "gcode/state/dwell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace batten::gcode {
namespace {

constexpr double kMsPerSecond = 1000;

bool is_dwell_code(const Word& word) { return word.letter == 'G' && word.value == 4; }

// The only word beside G4 and N; nullptr where there are others, or G4 stands twice.
const Word* time_word(std::span<const Word> words) {
  const Word* time = nullptr;
  int codes = 0;
  for (const Word& word : words) {
    if (word.letter == 'N') continue;
    if (!word.is_number) return nullptr;
    if (is_dwell_code(word)) {
      ++codes;
    } else if (time == nullptr) {
      time = &word;
    } else {
      return nullptr;
    }
  }
  return codes == 1 ? time : nullptr;
}

// Milliseconds in the unit of the word; 0 where that is not known.
double unit_of(const Word& word, DwellForm form) {
  const bool with_point = word.has_point;
  switch (form) {
    case DwellForm::kUnknown:
      return word.letter == 'X' && with_point ? kMsPerSecond : 0;
    case DwellForm::kSecondsP:
      return word.letter == 'P' ? kMsPerSecond : 0;
    case DwellForm::kSecondsX:
      return word.letter == 'X' ? kMsPerSecond : 0;
    case DwellForm::kSecondsXOrMsP:
      if (word.letter == 'X') return with_point ? kMsPerSecond : 0;
      return word.letter == 'P' && !with_point ? 1 : 0;
    case DwellForm::kSecondsByPoint:
      if (word.letter != 'P') return 0;
      return with_point ? kMsPerSecond : 1;
    case DwellForm::kSecondsF:
      return word.letter == 'F' ? kMsPerSecond : 0;
  }
  return 0;
}

}  // namespace

std::optional<std::int32_t> dwell_ms(std::span<const Word> words, DwellForm form) {
  const Word* time = time_word(words);
  if (time == nullptr) return std::nullopt;
  const double ms = time->value * unit_of(*time, form);
  constexpr double kRounding = 1e-6;  // of the product; a finer time is off by 0.001 or more
  if (!(ms >= 1 - kRounding && ms <= kLongestDwellMs)) return std::nullopt;
  const double whole = std::round(ms);
  if (std::abs(ms - whole) > kRounding) return std::nullopt;
  return static_cast<std::int32_t>(whole);
}

std::string dwell_seconds(std::int32_t ms, bool point) {
  std::string text = fmt::format("{}.{:03}", ms / 1000, ms % 1000);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.' && !point) text.pop_back();
  return text;
}

std::string dwell_block(std::int32_t ms, DwellForm form) {
  switch (form) {
    case DwellForm::kUnknown:
      return {};
    case DwellForm::kSecondsP:
      return "G4 P" + dwell_seconds(ms, false);
    case DwellForm::kSecondsX:
    case DwellForm::kSecondsXOrMsP:
      return "G4 X" + dwell_seconds(ms, true);
    case DwellForm::kSecondsByPoint:
      return "G4 P" + dwell_seconds(ms, true);
    case DwellForm::kSecondsF:
      return "G4 F" + dwell_seconds(ms, false);
  }
  return {};
}

}  // namespace batten::gcode
