#include "gcode/state/dwell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace batten::gcode {
namespace {

constexpr double kMsPerSecond = 1000;

// The only word beside G4 and N; nullptr where there are others, or G4 stands twice.
const Word* time_word(std::span<const Word> words) {
  const Word* time = nullptr;
  int codes = 0;
  for (const Word& word : words) {
    if (word.letter == 'N') continue;
    const bool is_dwell = word.letter == 'G' && word.value == 4;
    if (!word.is_number || (!is_dwell && time != nullptr)) return nullptr;
    if (!is_dwell) time = &word;
    codes += is_dwell ? 1 : 0;
  }
  return codes == 1 ? time : nullptr;
}

// A word that says a time under a form, the one that is written first, in milliseconds without a
// point and with one; 0: its unit is not certain.
struct TimeWord {
  DwellForm form;
  char letter;
  double without_point;
  double with_point;
};
constexpr TimeWord kTimeWords[] = {
    {DwellForm::kUnknown, 'X', 0, kMsPerSecond},
    {DwellForm::kSecondsP, 'P', kMsPerSecond, kMsPerSecond},
    {DwellForm::kSecondsX, 'X', kMsPerSecond, kMsPerSecond},
    {DwellForm::kSecondsXOrMsP, 'X', 0, kMsPerSecond},
    {DwellForm::kSecondsXOrMsP, 'P', 1, 0},
    {DwellForm::kSecondsByPoint, 'P', 1, kMsPerSecond},
    {DwellForm::kSecondsF, 'F', kMsPerSecond, kMsPerSecond},
};

double unit_of(const Word& word, DwellForm form) {
  for (const TimeWord& each : kTimeWords) {
    if (each.form != form || each.letter != word.letter) continue;
    return word.has_point ? each.with_point : each.without_point;
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
  if (form == DwellForm::kUnknown) return {};
  const TimeWord& word = *std::ranges::find(kTimeWords, form, &TimeWord::form);
  // X of other controls has another unit without a point.
  const bool point = word.letter == 'X' || word.without_point != word.with_point;
  return fmt::format("G4 {}{}", word.letter, dwell_seconds(ms, point));
}

}  // namespace batten::gcode
