// What the reader promises for any bytes whatever. Used by the fuzzer and by the unit tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "gcode/reading/parser.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode::promises {

inline constexpr std::array kLanguages = {Language::kRs274, Language::kSiemens,
                                          Language::kKlartext};

// The first block that does not continue where the one before it ended.
inline std::string broken_cover(const Program& program) {
  std::uint32_t expected = 0;
  std::uint32_t line = 0;
  for (const Block& block : program.blocks) {
    ++line;
    const bool continues = block.span.begin == expected && block.span.begin <= block.span.end &&
                           block.span.end <= block.end && block.end > block.span.begin;
    if (!continues || block.line != line) {
      return "block " + std::to_string(line) + " does not follow the one before it";
    }
    const std::string_view line_end =
        program.source.text().substr(block.span.end, block.end - block.span.end);
    if (!line_end.empty() && line_end != "\n" && line_end != "\r\n" && line_end != "\r") {
      return "line " + std::to_string(line) + " ends with something else than a line end";
    }
    expected = block.end;
  }
  return expected == program.source.text().size() ? "" : "bytes are left after the last block";
}

// Does the word stand for what its bytes say?
inline bool word_is_true(const Word& word, std::string_view text) {
  if (word.letter == ',' || !word.is_number) return true;
  const auto number = read_number(text.substr(1));
  const char letter = text.front() == ':' ? 'O' : upper(text.front());
  return letter == word.letter && number && number->value == word.value &&
         number->has_point == word.has_point &&
         (number->decimals == word.decimals || number->decimals > 255);
}

// A byte of an understood block that is in no word and no comment says nothing, or is a block
// delete sign, a check sum, or one of the bytes that controls skip.
inline bool may_stand_between(char c, const Block& block) {
  const bool sign = c == '/' && block.block_delete;
  const bool number_of_sign = is_digit(c) && (block.block_delete || block.has_checksum);
  const bool sum = c == '*' && block.has_checksum;
  const bool skipped = c == '\0' || c == '\x1A' || c == '\xEF' || c == '\xBB' || c == '\xBF';
  return is_blank(c) || sign || number_of_sign || sum || skipped;
}

// X#1, Y-[#<a>+2]: a value that variables make.
inline bool is_expression(std::string_view word) {
  return word.find('#') != std::string_view::npos || word.find('[') != std::string_view::npos;
}

// Words and comments lie inside their block, apart from each other. In RS-274 words are what their
// bytes say, and an understood block has no byte that nobody answers for; in other languages words
// have names and neighbours of many kinds.
inline std::string broken_block(const Program& program, const Block& block) {
  const std::string where = " in line " + std::to_string(block.line);
  std::string owned(block.span.size(), '\0');  // by a word or comment: 1
  const bool plain = program.language == Language::kRs274;
  const auto own = [&](SourceSpan span) {
    if (span.begin < block.span.begin || span.end > block.span.end || span.begin >= span.end) {
      return false;
    }
    const auto begin = owned.begin() + (span.begin - block.span.begin);
    const auto end = begin + (span.end - span.begin);
    const bool is_free = std::all_of(begin, end, [](char owner) { return owner == 0; });
    std::fill(begin, end, '\1');
    return is_free;
  };
  for (const Word& word : program.words_of(block)) {
    // A centre of Klartext stands in the block of its CC, and has no value once the coordinates
    // may be others.
    const bool elsewhere = program.language == Language::kKlartext &&
                           word.span.begin < word.span.end && word.span.end <= block.span.begin;
    if (!elsewhere && !own(word.span)) return "a word is not at its own place" + where;
    const std::string_view text = program.source.text(word.span);
    if (plain && !(word.computed ? is_expression(text) : word_is_true(word, text))) {
      return "a word is not what its bytes say" + where;
    }
    if (!elsewhere && block.opacity == ParseStatus::kNone &&
        (!word.is_number || word.letter == ',')) {
      return "a word without a value in a block that is said to be understood" + where;
    }
  }
  for (const Comment& comment : program.comments_of(block)) {
    if (!own(comment.span)) return "a comment is not at its own place" + where;
  }
  if (!plain || block.opacity != ParseStatus::kNone) return "";
  const std::string_view text = program.source.text(block.span);
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (owned[at] == 0 && !may_stand_between(text[at], block)) return "a byte was skipped" + where;
  }
  return "";
}

// At most one for each block, in the order of the program, beside one about the whole file and the
// number of those that were not told, which stands at the first of them: what that block is told
// for instead, it is told there too.
inline std::string broken_diagnostics(const Program& program, const Diagnostics& found) {
  auto block = program.blocks.begin();
  for (const Diagnostic& diagnostic : found) {
    if (diagnostic.id == "sixteen-bit-text") continue;
    if (diagnostic.message.starts_with("from here on ")) continue;
    while (block != program.blocks.end() && block->end <= diagnostic.where.begin) ++block;
    if (block == program.blocks.end() || diagnostic.where.begin < block->span.begin) {
      return "two diagnostics for one block, or one outside the program: " + diagnostic.message;
    }
    if (diagnostic.id.empty() || diagnostic.message.empty()) {
      return "a diagnostic without id or message";
    }
    ++block;
  }
  return "";
}

// The promise that does not hold for this text in this language; empty when all do.
inline std::string broken_by(std::string_view text, Language language = Language::kRs274) {
  Diagnostics found;
  const Program program = parse(SourceText("fuzz", std::string(text)), language, found);
  std::string broken = broken_cover(program);
  std::uint32_t words = 0;
  std::uint32_t comments = 0;
  for (const Block& block : program.blocks) {
    if (!broken.empty()) return broken;
    if (block.first_word < words || block.first_comment < comments) {
      return "blocks share words or comments";
    }
    words = block.first_word + block.word_count;
    comments = block.first_comment + block.comment_count;
    if (words > program.words.size() || comments > program.comments.size()) {
      return "a block has words or comments that are not there";
    }
    broken = broken_block(program, block);
  }
  return broken.empty() ? broken_diagnostics(program, found) : broken;
}

}  // namespace batten::gcode::promises
