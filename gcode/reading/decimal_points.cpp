#include "gcode/reading/decimal_points.h"

#include <fmt/format.h>

#include <string_view>

namespace batten::gcode {
namespace {

// Dwell, macro calls, high speed modes.
bool has_no_lengths(const BlockWords& words) {
  return words.has_trait(trait::kNoLengths) || (words.has_g(50) && !words.has_any("XYZIJ"));
}

}  // namespace

bool DecimalPoints::read(std::span<Word> words) {
  if (rule_.pointless == PointlessNumbers::kUnits || words.empty()) return false;
  const BlockWords sorted(words);
  follow(sorted);
  const bool no_lengths = has_no_lengths(sorted);
  bool unknown = false;
  for (Word& word : words) {
    if (!word.is_number || word.has_point || word.value == 0) continue;
    if (word.letter == 'F') word.without_point = true;
    if (no_lengths || !is_length(word.letter)) continue;
    word.without_point = true;
    // Controls differ in whether a knot or a weight without a point is counted in increments.
    if (rule_.pointless != PointlessNumbers::kUndeclared && mode_ != Mode::kCurve) {
      scale(word);
      continue;
    }
    if (!unknown && unknown_++ == 0) first_unknown_ = word;
    unknown = true;
    word.is_number = false;
  }
  return unknown;
}

void DecimalPoints::follow(const BlockWords& words) {
  units_ = units_set_by(words).value_or(units_);
  for (const Code code : words.g_codes()) {
    constexpr Code kNurbs = 62;
    const CodeRow& row = row_of_g(code);
    if (is_cycle(code)) {
      mode_ = Mode::kCycle;
    } else if (code == kNurbs) {
      mode_ = Mode::kCurve;
    } else if (row.is_plain_motion() || row.group == CodeGroup::kCycleEnd) {
      mode_ = Mode::kPlain;
    }
  }
}

bool DecimalPoints::is_length(char letter) const {
  if (letter == 'K') return mode_ != Mode::kCycle;
  return std::string_view("XYZUVWIJRQ").find(letter) != std::string_view::npos;
}

// Numbers without a point are whole, so the quotient is the double of the decimal that is meant.
void DecimalPoints::scale(Word& word) const {
  const int decimals = rule_.increment_decimals + (units_ == Units::kInch ? 1 : 0);
  word.value /= kPowersOfTen.at(static_cast<std::size_t>(decimals));
  word.decimals = static_cast<std::uint8_t>(decimals);
}

void DecimalPoints::tell(Diagnostics& found) const {
  if (unknown_ == 0) return;
  const std::string blocks = unknown_ == 1 ? "1 block" : fmt::format("{} blocks", unknown_);
  found.push_back(
      {Severity::kWarning, "implied-decimals", first_unknown_.span,
       fmt::format(
           "{0}{1:.0f} has no decimal point: {0}{1:.0f}. on some of these controls, {1:.0f} "
           "least increments on others. {2} of this kind stay as they are. Say --decimals "
           "explicit or --decimals implied",
           first_unknown_.letter, first_unknown_.value, blocks)});
}

}  // namespace batten::gcode
