#include "gcode/klartext/statement.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

namespace batten::gcode {
namespace {

// Where the comment starts: a ; outside of quoted names.
std::size_t comment_in_line(std::string_view line) {
  char quote = '\0';
  for (std::size_t at = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (quote != '\0') {
      quote = c == quote ? '\0' : quote;
    } else if (c == '"') {
      quote = c;
    } else if (c == ';') {
      return at;
    }
  }
  return line.size();
}

struct Keywords {
  KlartextKind kind;
  std::string_view words;  // with a blank on each side
};

// Of statements that one word tells.
constexpr std::array kKeywords = {
    Keywords{KlartextKind::kLine, " L "},
    Keywords{KlartextKind::kCentre, " CC "},
    Keywords{KlartextKind::kArc, " C "},
    Keywords{KlartextKind::kFunctions, " M "},
    Keywords{KlartextKind::kSpline, " SPL "},
    Keywords{KlartextKind::kTangential, " RND CHF CT CTP DEP FL FLT FC FCT FPOL FSELECT "},
    Keywords{KlartextKind::kPolar, " LP CP "},
    Keywords{KlartextKind::kRadiusArc, " CR "},
    Keywords{KlartextKind::kOtherPath, " LN APPR X Y Z IX IY IZ "},
    Keywords{KlartextKind::kPlane, " PLANE "},
    Keywords{KlartextKind::kStop, " STOP "},
    Keywords{KlartextKind::kLabel, " LBL "},
    Keywords{KlartextKind::kDefinition, " SEL "},
    Keywords{KlartextKind::kAssignment, " Q QL QR QS "},
};

struct KeywordPair {
  std::string_view first;
  std::string_view second;
  KlartextKind kind;
};

constexpr std::array kPairs = {
    KeywordPair{"BEGIN", "PGM", KlartextKind::kBegin},
    KeywordPair{"END", "PGM", KlartextKind::kEnd},
    KeywordPair{"TOOL", "CALL", KlartextKind::kToolCall},
    KeywordPair{"TOOL", "DEF", KlartextKind::kDefinition},
    KeywordPair{"BLK", "FORM", KlartextKind::kDefinition},
    KeywordPair{"PATTERN", "DEF", KlartextKind::kDefinition},
    KeywordPair{"CYCL", "DEF", KlartextKind::kCycleDef},
    KeywordPair{"CYCL", "CALL", KlartextKind::kCycleCall},
    KeywordPair{"CALL", "LBL", KlartextKind::kCallLabel},
    KeywordPair{"CALL", "PGM", KlartextKind::kCallProgram},
    KeywordPair{"TCH", "PROBE", KlartextKind::kProbe},
    KeywordPair{"FUNCTION", "TCPM", KlartextKind::kFunctionTcpm},
    KeywordPair{"FUNCTION", "RESET", KlartextKind::kFunctionTcpm},
};

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

  while (end > at && is_blank(text[end - 1])) --end;
  const std::uint32_t comment =
      at < end && text[at] == '*'
          ? at
          : at + static_cast<std::uint32_t>(comment_in_line(text.substr(at, end - at)));
  // The ~ of a line with a comment stands behind the comment or before it. A comment alone goes on
  // nowhere.
  if (comment > at && end > at && text[end - 1] == '~') {
    parts.continues = true;
    --end;
    while (end > at && is_blank(text[end - 1])) --end;
  }
  std::uint32_t content_end = std::min(comment, end);
  parts.comment = {content_end, std::max(end, content_end)};
  const auto trim = [&] {
    while (content_end > at && is_blank(text[content_end - 1])) --content_end;
  };
  trim();
  if (content_end > at && text[content_end - 1] == '~') {
    parts.continues = true;
    --content_end;
    trim();
  }
  parts.content = {at, content_end};
  return parts;
}

KlartextKind klartext_kind(std::string_view content) {
  if (content.empty()) return KlartextKind::kNothing;
  const std::string_view first = leading_letters(content);
  if (is_same_word(first, "FN")) return kind_of_function(content);
  const std::string word_alone = " " + in_capitals(first) + " ";
  for (const Keywords& each : kKeywords) {
    if (each.words.find(word_alone) != std::string_view::npos) return each.kind;
  }
  KlartextTokens tokens(content);
  const std::string_view word = tokens.next();
  const std::string_view second = leading_letters(tokens.next());
  for (const KeywordPair& pair : kPairs) {
    if (is_same_word(word, pair.first) && is_same_word(second, pair.second)) return pair.kind;
  }
  return KlartextKind::kUnknown;
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
