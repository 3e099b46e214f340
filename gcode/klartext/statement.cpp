#include "gcode/klartext/statement.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

namespace batten::gcode {
namespace {

// Where the comment starts: a ; outside of quoted names.
std::size_t comment_in_line(std::string_view line) {
  bool quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (line[at] == ';' && !quoted) return at;
    quoted ^= line[at] == '"';
  }
  return line.size();
}

// Of statements that one word tells, or two.
constexpr std::pair<KlartextKind, std::string_view> kKeywords[] = {
    {KlartextKind::kLine, "|L|"},
    {KlartextKind::kCentre, "|CC|"},
    {KlartextKind::kArc, "|C|"},
    {KlartextKind::kFunctions, "|M|"},
    {KlartextKind::kSpline, "|SPL|"},
    {KlartextKind::kTangential, "|RND|CHF|CT|CTP|DEP|FL|FLT|FC|FCT|FPOL|FSELECT|"},
    {KlartextKind::kPolar, "|LP|CP|"},
    {KlartextKind::kRadiusArc, "|CR|"},
    {KlartextKind::kOtherPath, "|LN|APPR|X|Y|Z|IX|IY|IZ|"},
    {KlartextKind::kPlane, "|PLANE|"},
    {KlartextKind::kStop, "|STOP|"},
    {KlartextKind::kLabel, "|LBL|"},
    {KlartextKind::kDefinition, "|SEL|TOOL DEF|BLK FORM|PATTERN DEF|"},
    {KlartextKind::kAssignment, "|Q|QL|QR|QS|"},
    {KlartextKind::kBegin, "|BEGIN PGM|"},
    {KlartextKind::kEnd, "|END PGM|"},
    {KlartextKind::kToolCall, "|TOOL CALL|"},
    {KlartextKind::kCycleDef, "|CYCL DEF|"},
    {KlartextKind::kCycleCall, "|CYCL CALL|"},
    {KlartextKind::kCallLabel, "|CALL LBL|"},
    {KlartextKind::kCallProgram, "|CALL PGM|"},
    {KlartextKind::kProbe, "|TCH PROBE|"},
    {KlartextKind::kFunctionTcpm, "|FUNCTION TCPM|FUNCTION RESET|"},
};

KlartextKind kind_of(const std::string& words) {
  const auto* row = std::ranges::find_if(kKeywords, [&](const auto& each) {
    return each.second.find(words) != std::string_view::npos;
  });
  return row == std::end(kKeywords) ? KlartextKind::kUnknown : row->first;
}

std::string_view leading_letters(std::string_view text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_letter);
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

// FN 0: Q1 = 5
KlartextKind kind_of_function(std::string_view content) {
  const std::size_t digit = content.find_first_of("0123456789");
  if (digit == std::string_view::npos) return KlartextKind::kUnknown;
  int number = -1;
  std::from_chars(content.data() + digit, content.data() + content.size(), number);
  if (number >= 9 && number <= 12) return KlartextKind::kJump;
  const bool computes = (number >= 0 && number <= 8) || number == 13 || number == 18;
  return computes ? KlartextKind::kAssignment : KlartextKind::kUnknown;
}

}  // namespace

KlartextParts klartext_parts(std::string_view text, SourceSpan line) {
  KlartextParts parts;
  std::uint32_t at = line.begin;
  std::uint32_t end = line.end;
  const auto skip_blanks = [&] {
    while (at < end && is_blank(text[at])) ++at;
  };
  const auto skip_slash = [&] {
    if (at < end && text[at] == '/' && !parts.skipped) {
      parts.skipped = true;
      ++at;
      skip_blanks();
    }
  };
  skip_blanks();
  skip_slash();
  parts.number.begin = at;
  while (at < end && is_digit(text[at])) ++at;
  parts.number.end = at;
  skip_blanks();
  skip_slash();

  // Blanks at the end, and one ~ with those before it.
  const auto trim = [&](std::uint32_t& stop) {
    while (stop > at && is_blank(text[stop - 1])) --stop;
  };
  const auto cut_end = [&](std::uint32_t& stop) {
    trim(stop);
    if (stop == at || text[stop - 1] != '~') return;
    parts.continues = true;
    --stop;
    trim(stop);
  };
  trim(end);
  const std::uint32_t comment =
      at < end && text[at] == '*'
          ? at
          : at + static_cast<std::uint32_t>(comment_in_line(text.substr(at, end - at)));
  // The ~ of a line with a comment stands behind the comment or before it. A comment alone goes on
  // nowhere.
  if (comment > at) cut_end(end);
  std::uint32_t content_end = std::min(comment, end);
  parts.comment = {content_end, std::max(end, content_end)};
  cut_end(content_end);
  parts.content = {at, content_end};
  return parts;
}

KlartextKind klartext_kind(std::string_view content) {
  if (content.empty()) return KlartextKind::kNothing;
  const std::string_view first = leading_letters(content);
  if (is_same_word(first, "FN")) return kind_of_function(content);
  const KlartextKind alone = kind_of("|" + in_capitals(first) + "|");
  if (alone != KlartextKind::kUnknown) return alone;
  KlartextTokens tokens(content);
  const std::string word = in_capitals(tokens.next());
  return kind_of("|" + word + " " + in_capitals(leading_letters(tokens.next())) + "|");
}

std::string_view KlartextTokens::next() {
  while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
  std::size_t length = 0;
  while (length < rest_.size() && !is_blank(rest_[length])) ++length;
  const std::string_view word = rest_.substr(0, length);
  rest_.remove_prefix(length);
  return word;
}

std::string_view KlartextTokens::peek() const {
  KlartextTokens ahead = *this;
  return ahead.next();
}

bool is_coefficient_line(std::string_view content) {
  return upper(char_at(content, 0)) == 'K' && char_at(content, 1) >= '1' &&
         char_at(content, 1) <= '3' && is_letter(char_at(content, 2));
}

bool KlartextScanner::at_end() {
  at_ = static_cast<std::uint32_t>(after_blanks(text_, at_));
  return at_ >= text_.size();
}

std::string KlartextScanner::letters() {
  std::string read;
  for (; is_letter(peek()); ++at_) read.push_back(upper(peek()));
  return read;
}

std::uint32_t KlartextScanner::skip_digits() {
  const std::uint32_t begin = at_;
  while (is_digit(peek())) ++at_;
  return at_ - begin;
}

std::optional<ReadNumber> KlartextScanner::number() {
  std::string digits;
  std::uint32_t end = at_;
  for (char c = peek();
       is_digit(c) || c == '.' || c == ',' || (digits.empty() && (c == '+' || c == '-'));
       c = char_at(text_, ++end)) {
    digits.push_back(c == ',' ? '.' : c);
  }
  const auto number = read_number(digits);
  if (!number || std::abs(number->value) >= kNumberLimit) return std::nullopt;
  at_ = end;
  return number;
}

}  // namespace batten::gcode
