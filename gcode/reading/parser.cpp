#include "gcode/reading/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/klartext/parser.h"
#include "gcode/reading/constants.h"
#include "gcode/reading/part_reading.h"
#include "gcode/reading/program_marks.h"
#include "gcode/reading/source_kind.h"
#include "gcode/rs274/lexer.h"
#include "gcode/rs274/plain_words.h"
#include "gcode/siemens/block.h"
#include "gcode/text/characters.h"
#include "gcode/text/large_pages.h"
#include "gcode/text/line_cursor.h"

namespace batten::gcode {
namespace {

// What the tape and file ends of old systems are filled with. Controls skip both.
constexpr char kNul = '\0';
constexpr char kEndOfFile = '\x1A';

constexpr std::string_view kUnreadableBlock = "unreadable-block";
constexpr std::string_view kUnclosedComment = "unclosed-comment";

// No control takes lines of more than some thousand bytes. What is longer than this is no line of
// a program, and its words would take many times its size of memory.
constexpr std::uint32_t kLongestLine = 1U << 20;

// $PART.MIN%: Okuma's line in front of a program that is sent. It is for the transfer alone.
bool is_okuma_file_name(std::string_view line) {
  if (line.size() < 3 || line.front() != '$' || line.back() != '%') return false;
  const std::string_view name = line.substr(1, line.size() - 2);
  return std::ranges::all_of(name,
                             [](char c) { return is_name_character(c) || c == '-' || c == '.'; }) &&
         std::ranges::count(name, '.') == 1;
}

// One pass over the source, line by line.
class Parser {
 public:
  Parser(const SourceText& source, Language language, const PartEnd& end, TextCarry& carry,
         Diagnostics& found)
      : program_{source, {}, {}, {}, language, carry.decimals.rule()},
        text_(source.text()),
        joined_(source.text()),
        end_(end),
        carry_(carry),
        found_(found),
        has_plain_way_(carry.short_ways && language == Language::kRs274) {}

  Program run() {
    reserve();
    if (!carry_.content_end) {
      const std::size_t last = text_.find_last_not_of(std::string_view("\0\x1A\r\n \t", 6));
      carry_.content_end = last == std::string_view::npos ? 0 : last + 1;
    }
    if (carry_.begin == 0 && (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF"))) {
      tell(Severity::kError, "sixteen-bit-text", SourceSpan{0, 2},
           "the file is text of 16 bits per character (UTF-16); expected bytes of ASCII. Save it "
           "as plain text or UTF-8");
    }
    const std::string_view text = text_.substr(0, end_.byte);
    LineCursor lines(text, carry_.begin);
    while (program_.blocks.size() < end_.blocks) {
      if (!read_plain_block(text)) {
        lines.go_to(carry_.begin);
        const auto line = lines.next();
        if (!line) break;
        read_block(*line);
        carry_.begin = line->end;
      }
    }
    carry_.blocks += static_cast<std::uint32_t>(program_.blocks.size());
    return std::move(program_);
  }

 private:
  // Room for lines as CAM systems write them (`X1.5Y-2.25` and the like): growing would copy
  // everything. Room that is not used takes no memory.
  void reserve() {
    constexpr std::size_t kBytesPerBlock = 16;
    constexpr std::size_t kMostBytesPerBlock = 48;  // where a part ends behind so many blocks
    constexpr std::size_t kBytesPerWord = 6;
    const std::size_t bytes = std::min<std::size_t>(text_.size(), end_.byte) - carry_.begin;
    const std::size_t blocks = std::min(bytes / kBytesPerBlock, end_.blocks);
    reserve_in_large_pages(program_.blocks, blocks + 1);
    reserve_in_large_pages(program_.words,
                           std::min(bytes, blocks * kMostBytesPerBlock) / kBytesPerWord + 1);
  }

  // False, and nothing read, where the line at the begin of what is left is no line of plain words.
  bool read_plain_block(std::string_view text) {
    if (!has_plain_way_ || carry_.begin >= text.size()) return false;
    if (follows_lone_return(text, carry_.begin)) return false;
    Block block = block_here();
    const auto line = read_plain_words(text, carry_.begin, program_.words);
    if (!line || line->text_end - line->begin > kLongestLine) {
      program_.words.resize(block.first_word);
      return false;
    }
    block.span = {line->begin, line->text_end};
    block.end = line->end;
    block.word_count = static_cast<std::uint32_t>(program_.words.size()) - block.first_word;
    carry_.words_seen = carry_.words_seen || block.word_count > 0;
    read_decimals(block);
    program_.blocks.push_back(block);
    carry_.begin = line->end;
    return true;
  }

  // The next one, without its line.
  [[nodiscard]] Block block_here() const {
    Block block;
    block.line = carry_.blocks + static_cast<std::uint32_t>(program_.blocks.size()) + 1;
    block.first_word = static_cast<std::uint32_t>(program_.words.size());
    block.first_comment = static_cast<std::uint32_t>(program_.comments.size());
    return block;
  }

  void read_block(const LineBounds& line) {
    Block block = block_here();
    block.span = {line.begin, line.text_end};
    block.end = line.end;
    const SourceSpan content = without_filling(block);
    if (joined_.holds(line)) {
      make_unreadable(block, content, kJoinedLine);
      carry_.words_seen = true;
    } else if (content.size() > 0 && text_[content.begin] == '%') {
      block.opacity = ParseStatus::kProgramMark;
      note_foreign_language(content);
    } else if (!carry_.words_seen && is_okuma_file_name(program_.source.text(content))) {
      block.opacity = ParseStatus::kProgramMark;
    } else if (content.size() > kLongestLine) {
      make_unreadable(block, content, "a line of more than 1 MiB");
      carry_.words_seen = true;
    } else {
      read_content(block, content);
    }
    block.word_count = static_cast<std::uint32_t>(program_.words.size()) - block.first_word;
    read_decimals(block);
    block.comment_count =
        static_cast<std::uint32_t>(program_.comments.size()) - block.first_comment;
    carry_.assigns |= block.opacity == ParseStatus::kAssignment;
    carry_.uses_variables |= carry_.assigns && block.opacity == ParseStatus::kExpression;
    program_.blocks.push_back(block);
    told_in_block_ = false;
  }

  void read_content(Block& block, SourceSpan content) {
    const bool nul = content.size() > 0 && has_nul(program_.source.text(block.span));
    if (nul) make_unreadable(block, block.span, kNulInLine);
    if (program_.language == Language::kSiemens) {
      read_siemens(block, content);
    } else {
      read_tokens(block, content);
    }
    if (nul) block.opacity = ParseStatus::kUnreadable;  // whatever its words are
  }

  void read_decimals(Block& block) {
    const bool of_words = block.opacity == ParseStatus::kNone ||
                          block.opacity == ParseStatus::kExpression ||
                          block.opacity == ParseStatus::kCornerWord;
    if (!of_words) return;
    const std::span<Word> words(program_.words.data() + block.first_word, block.word_count);
    if (carry_.decimals.read(words)) raise(block, ParseStatus::kExpression);
  }

  // The line without blanks, NULs and end-of-file signs at its edges. A line of nothing but
  // these signs becomes a program mark: it must not vanish with the lines around it.
  SourceSpan without_filling(Block& block) const {
    std::uint32_t begin = block.span.begin;
    std::uint32_t end = block.span.end;
    if (begin == 0 && text_.starts_with(kByteOrderMark)) {
      begin += static_cast<std::uint32_t>(kByteOrderMark.size());
    }
    bool filled = false;
    while (end > begin && is_filling(end - 1, filled)) {
      --end;
    }
    while (begin < end && is_filling(begin, filled)) {
      ++begin;
    }
    if (begin == end && filled) {
      block.opacity = ParseStatus::kProgramMark;
    }
    return {begin, end};
  }

  bool is_filling(std::uint32_t at, bool& filled) const {
    const char c = text_[at];
    if (is_blank(c)) {
      return true;
    }
    const bool sign = c == kNul || (c == kEndOfFile && at >= *carry_.content_end);
    filled = filled || sign;
    return sign;
  }

  void read_tokens(Block& block, SourceSpan content) {
    LineLexer lexer(text_, content);
    bool only_n = true;  // no word but N so far
    for (bool more = true; more;) {
      const Token& token = lexer.next();
      switch (token.kind) {
        case TokenKind::kWord:
        case TokenKind::kValueWord:
          add_word(token, token.letter);
          only_n = only_n && token.letter == 'N';
          if (token.kind == TokenKind::kValueWord) raise(block, ParseStatus::kExpression);
          break;
        case TokenKind::kCornerWord:
          add_word(token, ',');
          only_n = false;
          raise(block, ParseStatus::kCornerWord);
          break;
        case TokenKind::kComment:
        case TokenKind::kLineComment:
          add_comment(token);
          break;
        case TokenKind::kAssignment:
          raise(block, ParseStatus::kAssignment);
          break;
        case TokenKind::kBlockDelete:
          read_block_delete(block, token, only_n);
          break;
        case TokenKind::kChecksum:
          read_checksum(block, token, content);
          break;
        case TokenKind::kProgramNumber:
          read_program_number(block);
          add_word(token, token.letter);
          break;
        case TokenKind::kFlow:
          block.opacity = ParseStatus::kFlow;
          break;
        case TokenKind::kForeign:
          block.opacity = ParseStatus::kForeign;
          note_foreign_language(content);
          break;
        case TokenKind::kUnreadable:
          make_unreadable(block, token.span, token.trouble);
          break;
        case TokenKind::kEnd:
          more = false;
          break;
      }
    }
    if (block.opacity == ParseStatus::kAssignment && !only_n) {
      make_unreadable(block, content, "a parameter that is set beside other words");
    }
    carry_.words_seen = carry_.words_seen || has_words(block);
  }

  void read_siemens(Block& block, SourceSpan content) {
    const SiemensBlock line = read_siemens_block(text_, content, program_.words);
    block.block_delete = line.skip;
    if (block.opacity != ParseStatus::kProgramMark) {
      block.opacity = line.opacity == ParseStatus::kUnreadable ? ParseStatus::kNone : line.opacity;
    }
    if (line.opacity == ParseStatus::kUnreadable) {
      make_unreadable(block, line.trouble_at, line.trouble);
    }
    if (line.comment) {
      program_.comments.push_back({CommentKind::kSemicolon, *line.comment});
      note_foreign_language(*line.comment);
    }
    follow_iso_mode(block);
    carry_.words_seen = carry_.words_seen || has_words(block);
  }

  // G291: words of the ISO mode up to G290, which are not read.
  void follow_iso_mode(Block& block) {
    if (block.opacity == ParseStatus::kNamedWords) {
      const std::string_view text = program_.source.text(block.span);
      iso_mode_ = !has_g_word(text, "290") && (iso_mode_ || has_g_word(text, "291"));
    }
    if (iso_mode_ && has_words(block)) block.opacity = ParseStatus::kForeign;
  }

  static bool has_g_word(std::string_view text, std::string_view code) {
    const std::size_t at = text.find(code);
    const std::size_t end = at + code.size();
    return at != std::string_view::npos && at > 0 && upper(text[at - 1]) == 'G' &&
           (end >= text.size() || !is_digit(text[end]));
  }

  // Is there anything in the block that a control acts on?
  [[nodiscard]] bool has_words(const Block& block) const {
    const bool words = program_.words.size() > block.first_word;
    return block.opacity == ParseStatus::kNone ? words : block.opacity != ParseStatus::kProgramMark;
  }

  void add_word(const Token& token, char letter) {
    Word& word = program_.words.emplace_back();
    word.letter = letter;
    word.span = token.span;
    word.is_number = token.has_value;
    if (token.has_value) {
      word.decimals = static_cast<std::uint8_t>(std::min(token.number.decimals, 255));
      word.has_point = token.number.has_point;
      word.value = token.number.value;
    }
  }

  void add_comment(const Token& token) {
    Comment comment;
    comment.span = token.span;
    const std::string_view text = text_.substr(token.span.begin, token.span.size());
    if (is_active_comment(text)) {
      comment.kind = CommentKind::kActive;
    } else if (token.unclosed || has_nested_bracket(text)) {
      comment.kind = CommentKind::kUncertain;
    } else if (token.kind == TokenKind::kLineComment) {
      comment.kind = CommentKind::kSemicolon;
      note_foreign_language(token.span);
    }
    program_.comments.push_back(comment);
    if (token.unclosed) {
      tell(Severity::kWarning, kUnclosedComment, token.span,
           "'(' without ')'; read as a comment up to the end of the line");
    }
  }

  static bool has_nested_bracket(std::string_view comment) {
    return comment.starts_with('(') && comment.find('(', 1) != std::string_view::npos;
  }

  // Words that name no value are less than words that belong to no known grammar: what was
  // said first about a block is only replaced by what is worse.
  static void raise(Block& block, ParseStatus opacity) {
    const bool replaceable =
        block.opacity == ParseStatus::kNone || block.opacity == ParseStatus::kExpression;
    if (replaceable || opacity == ParseStatus::kAssignment) {
      block.opacity = opacity;
    }
  }

  void read_block_delete(Block& block, const Token& token, bool only_n) {
    if (block.block_delete || !only_n || block.opacity != ParseStatus::kNone) {
      make_unreadable(block, token.span, "a '/' that is not at the beginning of the block");
      return;
    }
    block.block_delete = true;
  }

  // The sum is the exclusive or of all bytes before the star.
  void read_checksum(Block& block, const Token& token, SourceSpan content) {
    const bool numbered =
        program_.words.size() > block.first_word && program_.words[block.first_word].letter == 'N';
    if (!numbered) {
      make_unreadable(block, token.span, "a check sum without a line number before it");
      return;
    }
    unsigned char sum = 0;
    for (const char c : text_.substr(content.begin, token.span.begin - content.begin)) {
      sum = static_cast<unsigned char>(sum ^ static_cast<unsigned char>(c));
    }
    if (token.number.value != sum) {
      make_unreadable(block, token.span, "a check sum that does not fit its line");
      return;
    }
    block.has_checksum = true;
  }

  // The first thing of a program may be its number, which no control acts on. Later ones
  // begin subprograms.
  void read_program_number(Block& block) {
    const bool alone = program_.words.size() == block.first_word && !block.block_delete;
    block.opacity = alone && !carry_.words_seen ? ParseStatus::kProgramMark : ParseStatus::kFlow;
    carry_.words_seen = true;
  }

  void make_unreadable(Block& block, SourceSpan where, std::string_view trouble) {
    if (block.opacity == ParseStatus::kUnreadable) {
      return;
    }
    block.opacity = ParseStatus::kUnreadable;
    tell(Severity::kWarning, kUnreadableBlock, where,
         std::string(trouble) + "; the block is copied as it is");
  }

  void note_foreign_language(SourceSpan where) {
    if (carry_.foreign_told) {
      return;
    }
    const auto language = language_of_line(text_.substr(where.begin, where.size()));
    if (!language || language->language == program_.language) {
      return;
    }
    carry_.foreign_told = true;
    tell(Severity::kError, "foreign-language", where,
         "found " + std::string(language->evidence) + ", so this is a program in " +
             std::string(describe(language->language)) +
             "; expected a program of the RS-274 family (G01 X.. Y..): this language is not read");
  }

  // One diagnostic per block: the first, unless an error follows.
  void tell(Severity severity, std::string_view id, SourceSpan where, std::string message) {
    if (severity == Severity::kError) {
      if (told_in_block_) {
        found_.pop_back();
      }
      found_.push_back({severity, id, where, std::move(message)});
    } else if (!told_in_block_ && flood(id).counts(where)) {
      found_.push_back({severity, id, where, std::move(message)});
    } else {
      return;
    }
    told_in_block_ = true;
  }

  ToldCount& flood(std::string_view id) {
    return id == kUnclosedComment ? carry_.unclosed : carry_.unreadable;
  }

  Program program_;
  std::string_view text_;
  JoinedLines joined_;
  PartEnd end_;
  TextCarry& carry_;
  Diagnostics& found_;
  bool has_plain_way_;
  bool told_in_block_ = false;
  bool iso_mode_ = false;
};

// The marks are closed when all blocks are read; their lines may have been told of already.
void close_marks(Program& program, Diagnostics& found) {
  Diagnostics at_marks;
  close_program_marks(program, at_marks);
  for (Diagnostic& diagnostic : at_marks) {
    const SourceSpan line = diagnostic.where;
    const bool told = std::any_of(found.begin(), found.end(), [&](const Diagnostic& other) {
      return other.where.begin >= line.begin && other.where.begin < line.end;
    });
    if (!told) {
      found.push_back(std::move(diagnostic));
    }
  }
}

// What is said of the whole text; puts all diagnostics from `first` on in order.
void finish(const TextCarry& carry, Diagnostics& found, std::size_t first) {
  for (const auto& [id, flood] : {std::pair(kUnreadableBlock, &carry.unreadable),
                                  std::pair(kUnclosedComment, &carry.unclosed)}) {
    if (flood->untold == 0) continue;
    found.push_back({Severity::kWarning, id, flood->first_untold,
                     fmt::format("from here on {} more blocks of this kind", flood->untold)});
  }
  carry.decimals.tell(found);
  std::stable_sort(
      found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
      [](const Diagnostic& a, const Diagnostic& b) { return a.where.begin < b.where.begin; });
}

}  // namespace

Program parse(const SourceText& source, const Reading& reading, Diagnostics& found) {
  if (reading.language == Language::kKlartext) {
    Program klartext = parse_klartext(source, found);
    if (!reading.keeps_expressions) compute_constants(klartext);
    return klartext;
  }
  const std::size_t before = found.size();
  TextCarry carry;
  if (reading.language == Language::kRs274) {
    carry.decimals = DecimalPoints(reading.decimals, reading.units);
  }
  carry.short_ways = reading.short_ways;
  Program program = Parser(source, reading.language, {}, carry, found).run();
  const bool siemens = reading.language == Language::kSiemens;
  program.dwells = siemens ? DwellForm::kSecondsF : reading.dwells;
  close_marks(program, found);
  if (!reading.keeps_expressions) compute_constants(program);
  finish(carry, found, before);
  return program;
}

Program parse(const SourceText& source, Language language, Diagnostics& found) {
  return parse(source, Reading{.language = language}, found);
}

Program parse(const SourceText& source, Diagnostics& found) {
  return parse(source, Language::kRs274, found);
}

Program parse_part(const SourceText& source, const PartEnd& end, TextCarry& carry,
                   Diagnostics& found) {
  Program part = Parser(source, Language::kRs274, end, carry, found).run();
  carry.marks.see(part);
  return part;
}

void finish_text(const TextCarry& carry, Diagnostics& found) { finish(carry, found, 0); }

}  // namespace batten::gcode
