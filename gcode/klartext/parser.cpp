#include "gcode/klartext/parser.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/klartext/move_words.h"
#include "gcode/klartext/statement.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

constexpr std::string_view kUnreadableBlock = "unreadable-block";

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

// What old files are filled with; controls skip both.
bool is_filler(char c) { return c == '\0' || c == '\x1A'; }

bool is_coefficient_line(std::string_view content) {
  return content.size() > 2 && upper(content[0]) == 'K' && content[1] >= '1' && content[1] <= '3' &&
         is_letter(content[2]);
}

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
    if (inner.begin == 0 && text_.starts_with(kUtf8Mark)) {
      inner.begin = std::min(inner.end, static_cast<std::uint32_t>(kUtf8Mark.size()));
    }
    bool filled = false;
    while (inner.begin < inner.end && is_filler(text_[inner.end - 1])) {
      --inner.end;
      filled = true;
    }
    while (inner.begin < inner.end && is_filler(text_[inner.begin])) {
      ++inner.begin;
      filled = true;
    }
    if (filled && inner.begin == inner.end) block.opacity = ParseStatus::kProgramMark;
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
    const bool of_spline = after_spline_ && is_coefficient_line(content);
    if (continued_ || of_spline) {
      block.opacity = ParseStatus::kContinued;
      continued_ = parts.continues;
      return;
    }
    continued_ = parts.continues;
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
        !parts.continues && read_klartext_move(kind, text_, parts.content, program_.words);
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
    if (!parts.continues && read_klartext_centre(text_, parts.content, centre_)) return;
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
      if (move.opacity == ParseStatus::kNone) move.opacity = ParseStatus::kCornerWord;
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
