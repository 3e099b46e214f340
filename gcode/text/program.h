// A program as blocks of words, each a span of the source. No text is copied.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gcode/text/language.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// A letter and its value, as `X-.5`.
struct Word {
  // Upper case, 'A' to 'Z'; or ',' for a corner word (,R2 ,C1 ,A45 ,K50), whose block is
  // ParseStatus::kCornerWord.
  char letter = 0;
  std::uint8_t decimals = 0;  // digits after the point as written
  bool has_point = false;     // a decimal point was written: X5. and X5 differ on old controls
  bool is_number =
      true;  // false: an expression, a parameter, or nothing; `value` means nothing then
  // A length or a feed without a decimal point, on a control for which that may matter. Where its
  // value is not known (Decimals), `is_number` is false.
  bool without_point = false;
  bool computed = false;  // an expression whose value is certain (gcode/reading/constants.h)
  double value = 0;
  SourceSpan span;  // in its block; a centre of Klartext stands in the block of the CC
};

enum class CommentKind : std::uint8_t {
  kParenthesis,  // (text)
  kSemicolon,    // ; text to the end of the line
  kActive,       // (MSG,..) (DEBUG,..) (PRINT,..) (LOG..) (PROBE..): acts when it is reached
  kUncertain,    // brackets nested or not closed: controls differ in where it ends
};

struct Comment {
  CommentKind kind = CommentKind::kParenthesis;
  SourceSpan span;  // with its brackets, or from the semicolon on
};

// Why a block was not split into plain words. Such blocks are copied as they are.
//
// A block of kNone, kExpression or kCornerWord lists all its words. The others list the words
// that were read before the reader stopped, so that an N number is there when it came first.
enum class ParseStatus : std::uint8_t {
  kNone,         // understood as words and comments
  kUnreadable,   // no grammar that is known
  kExpression,   // a word whose value is an expression or a parameter, X[#1+2], X#5, or is not
                 // known for want of a decimal point
  kAssignment,   // #1=.., #<name>=.., R1=..; besides them only N and comments
  kFlow,         // O-words, IF, WHILE, GOTO, DO, END, labels: the order of blocks changes
  kForeign,      // strings, $, {, !, @ lines, and words of other languages (DEF, CALL, ..)
  kProgramMark,  // a % line; text outside the % marks; the program's own number (O1000 before
                 // any other word); a line of NUL or 0x1A: controls do nothing here
  kCornerWord,   // ,R2 ,C1 ,A45: the path does not reach the point that the words name
  kContinued,    // a line that belongs to the statement of the lines before it
  kNamedWords,   // Siemens: words of several letters beside those that are listed
                 // (gcode/siemens/names.h)
};

// One line of the source.
struct Block {
  SourceSpan span;         // the line without its line end
  std::uint32_t end = 0;   // after the line end: next block's begin
  std::uint32_t line = 0;  // from 1
  std::uint32_t first_word = 0;
  std::uint32_t word_count = 0;
  std::uint32_t first_comment = 0;
  std::uint32_t comment_count = 0;
  ParseStatus opacity = ParseStatus::kNone;
  bool block_delete = false;  // starts with /, or /2 ..
  // Ends with *71, and the sum is right. The host counts such lines by their N: where one is
  // left out or added, all numbers and sums after it are wrong.
  bool has_checksum = false;
};

struct Program {
  SourceText source;
  std::vector<Block> blocks;  // every byte of the source belongs to exactly one block
  std::vector<Word> words;
  std::vector<Comment> comments;
  Language language = Language::kRs274;    // in which it was read
  Decimals decimals = {};                  // with which numbers without a point were read
  DwellForm dwells = DwellForm::kUnknown;  // what the words of its G4 mean

  [[nodiscard]] std::span<const Word> words_of(const Block& block) const {
    return {words.data() + block.first_word, block.word_count};
  }
  [[nodiscard]] std::span<const Comment> comments_of(const Block& block) const {
    return {comments.data() + block.first_comment, block.comment_count};
  }
};

// Whether the word numbers its block. An N after other words or a comment does not on all controls
// (LinuxCNC refuses the program), nor does N-1.
[[nodiscard]] bool is_block_number(const Program& program, const Block& block, const Word& word);

}  // namespace batten::gcode
