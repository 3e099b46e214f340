#include "gcode/klartext/parser.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/klartext/statement.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

constexpr std::string_view kUnreadableBlock = "unreadable-block";

// What old files are filled with; controls skip both.
bool is_filler(char c) { return c == '\0' || c == '\x1A'; }

// --- the words of L, C, CC and M statements ----------------------------------------------------

// M functions of machines and of the common set do what they do on other controls; these change
// how motions are read, or make some: M89, M91, M97 to M99 and everything above. M21 to M23 mirror
// elsewhere and are the builder's here.
bool is_plain_function(double code) {
  const bool mirrors_elsewhere = code >= 21 && code <= 23;
  constexpr double kFirstSpecial = 89;
  constexpr double kRestoresElsewhere = 72;
  return code < kFirstSpecial && !mirrors_elsewhere && code != kRestoresElsewhere;
}

constexpr int kGreatestDecimals = 255;

bool is_axis(char letter) {
  return std::string_view("XYZABCUVW").find(letter) != std::string_view::npos;
}

bool is_parameter(std::string_view letters) {
  return letters == "Q" || letters == "QL" || letters == "QR" || letters == "QS";
}

// The words of moves: a value may be a parameter.
class MoveWordReader : public KlartextScanner {
 public:
  using KlartextScanner::KlartextScanner;

  // Whether the value of a word begins behind the blanks here; goes there.
  bool finds_value() {
    KlartextScanner ahead = *this;
    if (ahead.at_end()) return false;
    const char c = ahead.peek();
    const bool value = is_digit(c) || c == '+' || c == '-' || c == '.' || c == ',';
    if (value) KlartextScanner::operator=(ahead);
    return value;
  }

  // +1,5 -2. Q5 -QL3; `word` begins before the value. False for anything else.
  bool read_value(Word& word) {
    const auto read = finds_value() ? number() : std::nullopt;
    if (!read) {
      if (peek() == '+' || peek() == '-') skip();
      return !at_end() && is_parameter(letters()) && read_parameter_number(word);
    }
    word.value = read->value;
    word.decimals = static_cast<std::uint8_t>(std::min(read->decimals, kGreatestDecimals));
    word.has_point = read->has_point;
    word.span.end = position();
    return true;
  }

  // The digits of a parameter whose letters were read.
  bool read_parameter_number(Word& word) {
    const bool any = skip_digits() > 0;
    word.is_number = false;
    word.span.end = position();
    return any;
  }
};

// Adds the words of RS-274 that say the same: G0 where FMAX is, otherwise G1, G2 or G3, then axes,
// G40 to G42, F and M. Q parameters and F AUTO are words without a number. A bare R, F or M, as old
// controls print them, says nothing. False where anything else is there (incremental words, feeds
// per tooth, M functions that change how motions are read ..), or where an arc has no DR, no end in
// X and Y, or a Z, or where a CR has no radius.
class MoveReading {
 public:
  MoveReading(KlartextKind kind, std::string_view text, SourceSpan content,
              std::vector<Word>& words)
      : kind_(kind), reader_(text, content), words_(words) {}

  bool read() {
    const std::uint32_t begin = reader_.position();
    if (kind_ != KlartextKind::kFunctions) {
      (void)reader_.letters();
      motion_ = add('G', 1, {begin, reader_.position()});
    }
    while (!reader_.at_end()) {
      if (!read_word()) return false;
    }
    if (rapid_ && has_word('F')) return false;  // the control takes one of them
    return !is_arc_kind() || (sense_ != 0 && arc_has_its_words());
  }

 private:
  bool read_word() {
    const std::uint32_t begin = reader_.position();
    const std::string name = reader_.letters();
    if (name.empty()) return false;
    if (name == "M") return read_function(begin);
    if (kind_ == KlartextKind::kFunctions) return false;
    if (name == "FMAX") return be_rapid(begin);
    if (name == "FAUTO") return add_parameter_feed(begin);
    if (name == "RL" || name == "RR") {
      (void)add('G', name == "RL" ? 41 : 42, {begin, reader_.position()});
      return true;
    }
    if (name == "DR") return read_sense();
    if (name == "R") return read_r(begin);
    if (name == "F") return read_feed(begin);
    const char letter = name[0];
    if (!is_axis(letter) && letter != 'F') return false;
    Word word = word_from(letter, begin);
    const bool read = name.size() == 1 ? reader_.read_value(word)
                                       : is_parameter(std::string_view(name).substr(1)) &&
                                             reader_.read_parameter_number(word);
    return add_if(read, word);
  }

  bool read_function(std::uint32_t begin) {
    if (!reader_.finds_value()) return reader_.at_end() || is_letter(reader_.peek());
    Word word = word_from('M', begin);
    if (!is_digit(reader_.peek()) || !reader_.read_value(word)) return false;
    words_.push_back(word);
    return is_plain_function(word.value);
  }

  bool read_feed(std::uint32_t begin) {
    Word word = word_from('F', begin);
    if (reader_.finds_value()) {
      return add_if(reader_.read_value(word), word);
    }
    if (reader_.at_end()) return true;
    MoveWordReader ahead = reader_;
    const std::string next = ahead.letters();
    const bool own = next == "MAX" || next == "AUTO" || is_parameter(next);
    if (!own) return true;  // a bare F
    reader_ = ahead;
    if (next == "MAX") return be_rapid(begin);
    if (next == "AUTO") return add_parameter_feed(begin);
    return add_if(reader_.read_parameter_number(word), word);
  }

  bool add_if(bool read, const Word& word) {
    if (read) words_.push_back(word);
    return read;
  }

  // The word that says it is part of the text that is compared.
  bool be_rapid(std::uint32_t begin) {
    if (kind_ != KlartextKind::kLine || std::exchange(rapid_, true)) return false;
    Word& word = words_[motion_];
    word.value = 0;
    word.span = {begin, reader_.position()};
    return true;
  }

  bool add_parameter_feed(std::uint32_t begin) {
    Word word = word_from('F', begin);
    word.is_number = false;
    word.span.end = reader_.position();
    words_.push_back(word);
    return true;
  }

  bool read_sense() {
    const char sign = reader_.peek();
    if (!is_arc_kind() || sense_ != 0 || (sign != '+' && sign != '-')) return false;
    reader_.skip();
    sense_ = sign == '+' ? 1 : -1;
    words_[motion_].value = sense_ > 0 ? 3 : 2;
    words_[motion_].span.begin = reader_.position() - 3;  // DR+
    words_[motion_].span.end = reader_.position();
    return true;
  }

  // R0, or the radius of CR.
  bool read_r(std::uint32_t begin) {
    const bool signed_value = reader_.peek() == '+' || reader_.peek() == '-';
    if (kind_ == KlartextKind::kRadiusArc && (signed_value || reader_.peek() != '0')) {
      Word word = word_from('R', begin);
      return add_if(reader_.read_value(word), word);
    }
    if (reader_.at_end() || is_letter(reader_.peek())) return true;  // a bare R
    if (reader_.peek() != '0' || begin + 1 != reader_.position()) return false;
    Word zero;
    if (!reader_.read_value(zero) || zero.value != 0) return false;
    (void)add('G', 40, {begin, reader_.position()});
    return true;
  }

  [[nodiscard]] bool is_arc_kind() const {
    return kind_ == KlartextKind::kArc || kind_ == KlartextKind::kRadiusArc;
  }

  [[nodiscard]] bool has_word(char letter) const {
    return std::any_of(words_.begin() + static_cast<std::ptrdiff_t>(motion_), words_.end(),
                       [letter](const Word& word) { return word.letter == letter; });
  }

  [[nodiscard]] bool arc_has_its_words() const {
    const bool radius = kind_ == KlartextKind::kRadiusArc;
    return (has_word('X') || has_word('Y')) && !has_word('Z') && radius == has_word('R');
  }

  static Word word_from(char letter, std::uint32_t begin) {
    Word word;
    word.letter = letter;
    word.span.begin = begin;
    return word;
  }

  std::size_t add(char letter, double value, SourceSpan span) {
    Word word = word_from(letter, span.begin);
    word.value = value;
    word.span = span;
    words_.push_back(word);
    return words_.size() - 1;
  }

  KlartextKind kind_;
  MoveWordReader reader_;
  std::vector<Word>& words_;
  std::size_t motion_ = 0;  // index of its word
  bool rapid_ = false;
  int sense_ = 0;
};

// Adds I and J for `CC X+10 Y+0`. False where the centre is not two plain numbers.
bool read_centre_words(std::string_view text, SourceSpan content, std::vector<Word>& words) {
  MoveWordReader reader(text, content);
  (void)reader.letters();  // CC
  while (!reader.at_end()) {
    Word word;
    word.span.begin = reader.position();
    const std::string name = reader.letters();
    if (name != "X" && name != "Y") return false;
    word.letter = name == "X" ? 'I' : 'J';
    if (!reader.read_value(word) || !word.is_number) return false;
    words.push_back(word);
  }
  return words.size() == 2 && words[0].letter != words[1].letter;
}

// --- blocks --------------------------------------------------------------------------------------

class KlartextParser {
 public:
  KlartextParser(const SourceText& source, Diagnostics& found)
      : text_(source.text()), joined_(source.text()), found_(found) {
    program_.source = source;
    program_.language = Language::kKlartext;
  }

  Program run() {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
      found_.push_back({Severity::kError, "sixteen-bit-text", SourceSpan{0, 2},
                        "the file is text of 16 bits per character (UTF-16); expected bytes of "
                        "ASCII. Save it as plain text or UTF-8"});
    }
    LineCursor lines(text_);
    while (const auto line = lines.next()) read_line(*line);
    told_.tell_rest(found_);
    return std::move(program_);
  }

 private:
  void read_line(const LineBounds& line) {
    Block block;
    block.span = {line.begin, line.text_end};
    block.end = line.end;
    block.line = static_cast<std::uint32_t>(program_.blocks.size()) + 1;
    block.first_word = static_cast<std::uint32_t>(program_.words.size());
    block.first_comment = static_cast<std::uint32_t>(program_.comments.size());
    const SourceSpan inner = without_fillers(block);
    if (joined_.holds(line)) {
      make_unreadable(block, kJoinedLine);
    } else if (inner.size() > 0 && has_nul(program_.source.text(block.span))) {
      make_unreadable(block, kNulInLine);
    } else {
      read_content(block, inner);
    }
    block.word_count = static_cast<std::uint32_t>(program_.words.size()) - block.first_word;
    block.comment_count =
        static_cast<std::uint32_t>(program_.comments.size()) - block.first_comment;
    program_.blocks.push_back(block);
  }

  void make_unreadable(Block& block, std::string_view trouble) {
    block.opacity = ParseStatus::kUnreadable;
    end_last_move();  // RND may stand there
    forget_path();
    if (!told_.counts(kUnreadableBlock, block.span)) return;
    found_.push_back({Severity::kWarning, kUnreadableBlock, block.span,
                      std::string(trouble) + "; the block is copied as it is"});
  }

  // A line of nothing but fillers is a mark: it must not vanish with the lines around it.
  SourceSpan without_fillers(Block& block) const {
    SourceSpan inner = block.span;
    if (inner.begin == 0 && text_.starts_with(kByteOrderMark)) {
      inner.begin = std::min(inner.end, static_cast<std::uint32_t>(kByteOrderMark.size()));
    }
    const bool filled = inner.size() > 0;
    while (inner.size() > 0 && is_filler(text_[inner.end - 1])) --inner.end;
    while (inner.size() > 0 && is_filler(text_[inner.begin])) ++inner.begin;
    if (filled && inner.size() == 0) block.opacity = ParseStatus::kProgramMark;
    return inner;
  }

  void read_content(Block& block, SourceSpan inner) {
    const KlartextParts parts = klartext_parts(text_, inner);
    block.block_delete = parts.skipped;
    if (parts.number.size() > 0) add_number(parts.number);
    if (parts.comment.size() > 0) {
      program_.comments.push_back({CommentKind::kSemicolon, parts.comment});
    }
    const std::string_view content = program_.source.text(parts.content);
    const bool goes_on = continued_ || (after_spline_ && is_coefficient_line(content));
    continued_ = parts.continues;
    if (goes_on) {
      block.opacity = ParseStatus::kContinued;
      return;
    }
    const KlartextKind kind = klartext_kind(content);
    after_spline_ = kind == KlartextKind::kSpline;
    if (kind != KlartextKind::kNothing) read_statement(kind, parts, block);
  }

  void read_statement(KlartextKind kind, const KlartextParts& parts, Block& block) {
    switch (kind) {
      case KlartextKind::kLine:
      case KlartextKind::kFunctions:
      case KlartextKind::kRadiusArc:
        return read_move(kind, parts, block);
      case KlartextKind::kArc:
        read_move(kind, parts, block);
        return add_centre();
      case KlartextKind::kCentre:
        return read_centre(parts, block);
      case KlartextKind::kTangential:
        block.opacity = ParseStatus::kForeign;
        end_last_move();
        return add_centre();
      case KlartextKind::kPolar:
      case KlartextKind::kOtherPath:
      case KlartextKind::kSpline:
        block.opacity = ParseStatus::kForeign;
        last_move_.reset();
        return add_centre();
      case KlartextKind::kBegin:
      case KlartextKind::kEnd:
        block.opacity = ParseStatus::kProgramMark;
        break;
      case KlartextKind::kAssignment:
        block.opacity = ParseStatus::kAssignment;
        return;
      case KlartextKind::kJump:
      case KlartextKind::kLabel:
      case KlartextKind::kCallLabel:
      case KlartextKind::kCallProgram:
        block.opacity = ParseStatus::kFlow;
        break;
      case KlartextKind::kDefinition:
        block.opacity = ParseStatus::kForeign;
        return;
      default:
        block.opacity = ParseStatus::kForeign;
        break;
    }
    forget_path();
  }

  // What follows may be in other coordinates: the numbers of the centre say nothing any more.
  void forget_path() {
    for (Word& word : centre_) word.is_number = false;
    last_move_.reset();
  }

  void add_number(SourceSpan span) {
    Word word;
    word.letter = 'N';
    word.span = span;
    if (const auto number = read_number(program_.source.text(span))) word.value = number->value;
    program_.words.push_back(word);
  }

  void read_move(KlartextKind kind, const KlartextParts& parts, Block& block) {
    const std::size_t first = program_.words.size();
    const bool plain =
        !parts.continues && MoveReading(kind, text_, parts.content, program_.words).read();
    if (!plain) {
      program_.words.resize(first);
      block.opacity = ParseStatus::kForeign;
      last_move_.reset();
      return;
    }
    const bool all_numbers =
        std::all_of(program_.words.begin() + static_cast<std::ptrdiff_t>(first),
                    program_.words.end(), [](const Word& word) { return word.is_number; });
    if (!all_numbers) block.opacity = ParseStatus::kExpression;
    if (kind != KlartextKind::kFunctions) last_move_ = program_.blocks.size();
  }

  // Its words are kept for the arcs behind it; the block itself does nothing.
  void read_centre(const KlartextParts& parts, Block& block) {
    centre_.clear();
    if (!parts.continues && read_centre_words(text_, parts.content, centre_)) return;
    Word whole;
    whole.letter = 'I';
    whole.is_number = false;
    whole.span = parts.content;
    centre_ = {whole};
    block.opacity = ParseStatus::kForeign;
  }

  // The centre is a part of what the block says.
  void add_centre() { program_.words.insert(program_.words.end(), centre_.begin(), centre_.end()); }

  // The motion before stops short of its end, or another one depends on its direction.
  void end_last_move() {
    if (last_move_) {
      Block& move = program_.blocks[*last_move_];
      const bool moves =
          move.opacity == ParseStatus::kNone || move.opacity == ParseStatus::kExpression;
      if (moves) move.opacity = ParseStatus::kCornerWord;
    }
    last_move_.reset();
  }

  Program program_{SourceText("", ""), {}, {}, {}, Language::kKlartext};
  std::string_view text_;
  JoinedLines joined_;
  DiagnosticLimiter told_;
  Diagnostics& found_;
  std::vector<Word> centre_;  // of the last CC
  std::optional<std::size_t> last_move_;
  bool continued_ = false;
  bool after_spline_ = false;
};

}  // namespace

Program parse_klartext(const SourceText& source, Diagnostics& found) {
  return KlartextParser(source, found).run();
}

}  // namespace batten::gcode
