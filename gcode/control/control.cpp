#include "gcode/control/control.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "gcode/rs274/lexer.h"
#include "gcode/state/mode_words.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

NumberFormat format_of(const Control& control, const DecimalsByUnit& decimals, Units units) {
  return {units == Units::kInch ? decimals.inch : decimals.mm, control.trailing_zeros,
          control.decimal_point};
}

bool can_stand_in_comment(char c) { return c >= ' ' && c <= '~' && c != '(' && c != ')'; }

}  // namespace

NumberFormat place_format(const Control& control, Units units) {
  return format_of(control, control.places, units);
}

NumberFormat arc_end_format(const Control& control, Units units) {
  return format_of(control, control.arc_ends, units);
}

NumberFormat center_format(const Control& control, Units units) {
  return format_of(control, control.centers, units);
}

NumberFormat feed_format(const Control& control) {
  return {control.feed_decimals, false, control.decimal_point};
}

std::size_t line_length(const Control& control, std::string_view line) {
  if (control.line_count == LineCount::kAll) return line.size();
  const bool blanks_count = control.line_count == LineCount::kWithoutComments;
  std::size_t kept = 0;
  bool in_parentheses = false;
  for (const char c : line) {
    if (in_parentheses) {
      in_parentheses = c != ')';
    } else if (c == ';') {
      break;
    } else if (c == '(') {
      in_parentheses = true;
    } else if (blanks_count || static_cast<unsigned char>(c) > ' ') {
      ++kept;
    }
  }
  return kept;
}

bool takes_arcs_in(const Control& control, Plane plane) {
  return plane != Plane::kUnknown && control.planes[static_cast<std::size_t>(plane) - 1];
}

double max_arc_sweep(const Control& control) {
  return control.max_sweep_deg * (std::numbers::pi / 180);
}

bool may_imply_decimals(const Control& control) {
  return control.has_increments && control.decimal_point;
}

std::string_view unit_word(const Control& control, Units units) {
  return units == Units::kInch ? control.unit_words.inch : control.unit_words.mm;
}

std::string_view other_meaning(const Control& control, int g_code) {
  const auto found = std::ranges::find(control.other_meanings, g_code, &OtherMeaning::g_code);
  return found == control.other_meanings.end() ? std::string_view() : found->text;
}

namespace {

// Whether the control takes the word that `text` begins with for another one.
bool has_other_meaning(const Control& control, std::string_view text) {
  if (!text.starts_with('G')) return false;
  double number = 0.0;
  std::from_chars(text.data() + 1, text.data() + text.size(), number);
  return !other_meaning(control, static_cast<int>(std::lround(10.0 * number))).empty();
}

}  // namespace

std::vector<std::string_view> words_of_modes(const Control& control) {
  constexpr int kInch = 200;
  const bool is_rs274 = control.language == Language::kRs274;
  const auto word_of = [&](const ModeWords& each, ModeSet mode) {
    if (is_rs274 && mode == mode::kControlSmoothing) return control.smoothing_off;
    const bool has_other_units = is_rs274 && !other_meaning(control, kInch).empty();
    return mode == mode::kUnits && has_other_units ? each.siemens : each.in(control.language);
  };
  std::vector<std::string_view> words;
  ModeSet mode = 1;
  for (const ModeWords& each : mode_words()) {
    const std::string_view word = word_of(each, mode);
    const bool is_new = !word.empty() && std::ranges::find(words, word) == words.end();
    const bool is_taken = is_rs274 && has_other_meaning(control, word);
    if ((control.lacks & mode) == 0 && is_new && !is_taken) words.push_back(word);
    mode <<= 1U;
  }
  return words;
}

bool refuses_word(const Control& control, char letter, int number) {
  std::string_view rest = control.refused;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (word.front() != letter) continue;
    if (word.size() == 1) return true;
    const auto refused = read_number(word.substr(1));
    if (refused && std::lround(refused->value * 10) == number) return true;
  }
  return false;
}

std::string comment_line(const Control& control, std::string_view text) {
  std::string line = "(" + std::string(text) + ")";
  const bool can_be_said = control.comments != CommentStyle::kNone &&
                           std::ranges::all_of(text, can_stand_in_comment) &&
                           text.find_first_of(control.not_in_comments) == std::string_view::npos &&
                           !is_active_comment(line);
  if (!can_be_said) return {};
  if (control.comments == CommentStyle::kSemicolon) {
    line = "; " + std::string(text);
  } else if (control.capital_comments) {
    std::ranges::transform(line, line.begin(), upper);
  }
  if (line_length(control, line) > control.max_line_length) return {};
  return line;
}

}  // namespace batten::gcode
