#include "gcode/siemens/block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

// G20 and G21 belong to the ISO mode of these controls; they are no other words elsewhere.
constexpr std::array kCommonG = {0,  1,  2,  3,  4,  9,  17, 18, 19, 20, 21, 33, 40, 41, 42,
                                 53, 54, 55, 56, 57, 60, 64, 90, 91, 93, 94, 95, 96, 97};

// Whether a G word means what it means on controls of the RS-274 family, as far as the interpreter
// follows it.
bool is_common_siemens_g(double value) { return std::ranges::count(kCommonG, value) > 0; }

constexpr std::array<std::string_view, 20> kFlowNames = {
    "IF",    "ELSE",    "ENDIF", "WHILE", "ENDWHILE", "FOR",     "ENDFOR",
    "LOOP",  "ENDLOOP", "UNTIL", "CASE",  "REPEAT",   "REPEATB", "GOTO",
    "GOTOF", "GOTOB",   "GOTOC", "GOTOS", "REPEATP",  "DEFAULT"};

constexpr std::string_view kLetters = "NGXYZIJKFSTDMHABCUVW";

class BlockReader {
 public:
  BlockReader(std::string_view source, SourceSpan line, std::vector<Word>& words)
      : source_(source), lexer_(source, line), words_(words) {}

  SiemensBlock read() {
    for (;;) {
      const SiemensToken token = lexer_.next();
      switch (token.kind) {
        case SiemensTokenKind::kEnd:
          return finished();
        case SiemensTokenKind::kComment:
          block_.comment = token.span;
          break;
        case SiemensTokenKind::kSkip:
          if (block_.skip || anything_) return unreadable(token, "a second '/'");
          block_.skip = true;
          break;
        case SiemensTokenKind::kLabel:
          label_ = true;
          break;
        case SiemensTokenKind::kWord:
        case SiemensTokenKind::kValueWord:
          take_word(token);
          break;
        case SiemensTokenKind::kName: {
          const std::string name = in_capitals(source_.substr(token.name.begin, token.name.size()));
          if (std::ranges::find(kFlowNames, name) != kFlowNames.end()) {
            block_.opacity = ParseStatus::kFlow;
            return block_;
          }
          take_name(token, name);
          // What follows is a list of names, which no word of a block looks like.
          if (name == "DEF" || name == "EXTERN") return finished();
          break;
        }
        case SiemensTokenKind::kUnreadable:
          return unreadable(token, token.trouble);
      }
    }
  }

 private:
  SiemensBlock unreadable(const SiemensToken& token, std::string_view trouble) {
    block_.opacity = ParseStatus::kUnreadable;
    block_.trouble = trouble;
    block_.trouble_at = token.span;
    return block_;
  }

  void add_word(const SiemensToken& token, char letter) {
    Word& word = words_.emplace_back();
    word.letter = letter;
    word.span = token.span;
    word.is_number = token.kind == SiemensTokenKind::kWord;
    if (word.is_number) {
      constexpr int kGreatestDecimalCount = std::numeric_limits<std::uint8_t>::max();
      word.decimals =
          static_cast<std::uint8_t>(std::min(token.number.decimals, kGreatestDecimalCount));
      word.has_point = token.number.has_point;
      word.value = token.number.value;
    }
  }

  void take_word(const SiemensToken& token) {
    const bool number = token.kind == SiemensTokenKind::kWord;
    anything_ = anything_ || token.letter != 'N';
    words_beside_ = words_beside_ || token.letter != 'N';
    if (token.letter == 'G' && number && !is_common_siemens_g(token.number.value)) {
      named_ = true;
      return;
    }
    if (kLetters.find(token.letter) == std::string_view::npos ||
        (token.letter == 'M' && number && token.number.value == 17)) {
      foreign_ = true;  // L100 P3: a subprogram; M17: the end of one
      return;
    }
    named_ = named_ || token.letter == 'D';  // a tool offset at once
    expression_ = expression_ || !number;
    add_word(token, token.letter);
  }

  void take_name(const SiemensToken& token, const std::string& name) {
    anything_ = true;
    if (name[0] == 'R' && is_numbered(name) && token.assigned) {
      assigns_ = true;
      return;
    }
    words_beside_ = true;
    if (name == "CR" && token.assigned) return take_radius(token);
    named_ = true;
  }

  // CR=10 is the R of other controls.
  void take_radius(SiemensToken token) {
    const std::size_t equals = source_.find('=', token.name.end);
    const auto number = read_number(source_.substr(equals + 1, token.span.end - equals - 1));
    const bool plain = number && number->value < kNumberLimit && number->value > -kNumberLimit;
    token.kind = plain ? SiemensTokenKind::kWord : SiemensTokenKind::kValueWord;
    if (plain) token.number = *number;
    expression_ = expression_ || !plain;
    add_word(token, 'R');
  }

  SiemensBlock finished() {
    if (foreign_) {
      block_.opacity = ParseStatus::kForeign;
    } else if (assigns_ && !words_beside_ && !label_) {
      block_.opacity = ParseStatus::kAssignment;
    } else if (named_ || assigns_ || label_) {
      block_.opacity = ParseStatus::kNamedWords;
    } else if (expression_) {
      block_.opacity = ParseStatus::kExpression;
    }
    return block_;
  }

  std::string_view source_;
  SiemensLexer lexer_;
  std::vector<Word>& words_;
  SiemensBlock block_;
  bool anything_ = false;      // but N
  bool words_beside_ = false;  // something that is neither N nor sets an R parameter
  bool label_ = false;
  bool named_ = false;
  bool foreign_ = false;
  bool assigns_ = false;
  bool expression_ = false;
};

}  // namespace

SiemensBlock read_siemens_block(std::string_view source, SourceSpan line,
                                std::vector<Word>& words) {
  return BlockReader(source, line, words).read();
}

std::string siemens_name(std::string_view source, const SiemensToken& token) {
  if (token.kind == SiemensTokenKind::kName) {
    std::string name = in_capitals(source.substr(token.name.begin, token.name.size()));
    return name == "CR" ? std::string() : name;
  }
  if (token.letter == 'D') return "D";
  if (token.kind != SiemensTokenKind::kWord || token.letter != 'G' ||
      is_common_siemens_g(token.number.value)) {
    return {};
  }
  const double code = token.number.value;
  constexpr double kGreatestCode = 999;
  const bool whole = code >= 0 && code <= kGreatestCode && code == std::floor(code);
  return whole ? "G" + std::to_string(static_cast<int>(code)) : "G?";
}

std::vector<SiemensName> siemens_names_in(std::string_view source, SourceSpan block) {
  std::vector<SiemensName> names;
  SiemensLexer lexer(source, block);
  for (;;) {
    const SiemensToken token = lexer.next();
    if (token.kind == SiemensTokenKind::kEnd || token.kind == SiemensTokenKind::kComment) break;
    std::string name = token.kind == SiemensTokenKind::kLabel
                           ? in_capitals(source.substr(token.span.begin, token.span.size()))
                           : siemens_name(source, token);
    if (!name.empty()) names.push_back({std::move(name), token.span});
  }
  return names;
}

}  // namespace batten::gcode
