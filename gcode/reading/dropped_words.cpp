#include "gcode/reading/dropped_words.h"

#include <algorithm>
#include <array>
#include <span>

#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/code_table.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"

namespace batten::gcode {
namespace {

// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): rows of a short table
struct DroppableWord {
  std::string_view name;
  Code code;                 // in tenths
  std::string_view letters;  // that belong to it
  bool alone;                // another code with axes beside it
};
constexpr std::array kWords = {
    DroppableWord{"G64", 640, "PQR", false},   // how near to the path a control stays
    DroppableWord{"G187", 1870, "PE", false},  // Haas: smoothness
    DroppableWord{"G5.1", 51, "QR", true},     // high speed mode; with axes a quadratic curve
    DroppableWord{"G5", 50, "P", true},        // P10000; with axes a cubic curve
};

// Codes that take none of the letters above: beside them it is certain whose a letter is.
constexpr std::array<Code, 19> kBeside = {0,   10,  170, 180, 190, 200, 210, 400, 490, 540,
                                          550, 560, 570, 580, 590, 800, 900, 940, 901};

const DroppableWord* find(std::string_view name) {
  const auto* found = std::ranges::find(kWords, name, &DroppableWord::name);
  return found == kWords.end() ? nullptr : found;
}

bool owns(const DroppableWord& row, const Word& word) {
  return row.letters.find(word.letter) != std::string_view::npos;
}

// Whether the block has the word and all that goes with it is certain.
bool may_lose(const Block& block, std::span<const Word> words, const DroppableWord& row) {
  if (block.opacity != ParseStatus::kNone || block.block_delete || block.has_checksum) return false;
  int found = 0;
  bool has_letters = false;
  bool has_other_code = false;
  for (const Word& word : words) {
    if (word.letter == 'G' && code_of(word) == row.code) {
      ++found;
    } else if (owns(row, word)) {
      has_letters = true;
    } else if (row.alone && word.letter != 'N') {
      return false;
    } else if (word.letter == 'M' ||
               (word.letter == 'G' && std::ranges::count(kBeside, code_of(word)) == 0)) {
      has_other_code = true;
    }
  }
  return found == 1 && !(has_letters && has_other_code);
}

// G5 P needs its P, since G5 alone may be a curve that goes on.
bool is_whole(std::span<const Word> words, const DroppableWord& row) {
  return !row.alone ||
         std::ranges::any_of(words, [&](const Word& each) { return owns(row, each); });
}

void erase(std::string& line, SourceSpan word) {
  std::size_t begin = word.begin;
  std::size_t end = word.end;
  while (begin > 0 && is_blank(line[begin - 1])) --begin;
  if (begin == 0) {
    while (end < line.size() && is_blank(line[end])) ++end;
  }
  line.erase(begin, end - begin);
}

// Whether there may be a G word whose number begins so; in a comment, too. Nearly all lines have
// none, and are not parsed.
bool may_have(std::string_view text, std::string_view digits) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (upper(text[at]) != 'G') continue;
    std::size_t digit = at + 1;
    while (is_blank(char_at(text, digit)) || char_at(text, digit) == '0') ++digit;
    if (text.substr(digit).starts_with(digits)) return true;
  }
  return false;
}

// G64 may be what ends one of these modes: without it they would stay.
bool needs_g64(std::string_view text) {
  return may_have(text, "61") || may_have(text, "62") || may_have(text, "63");
}

std::size_t drop_in(std::string& line, const DroppableWord& row) {
  if (!may_have(line, row.name.substr(1, 1))) return 0;
  Diagnostics ignored;
  const Program program = parse(SourceText("", line), ignored);
  if (program.blocks.size() != 1) return 0;
  const Block& block = program.blocks.front();
  const std::span<const Word> words = program.words_of(block);
  if (!may_lose(block, words, row) || !is_whole(words, row)) return 0;
  for (std::size_t i = words.size(); i-- > 0;) {
    if ((words[i].letter == 'G' && code_of(words[i]) == row.code) || owns(row, words[i])) {
      erase(line, words[i].span);
    }
  }
  return 1;
}

}  // namespace

std::vector<std::string_view> droppable_words() {
  std::vector<std::string_view> names;
  names.reserve(std::size(kWords));
  for (const DroppableWord& row : kWords) names.push_back(row.name);
  return names;
}

std::string_view droppable_name(std::string_view word) {
  Diagnostics ignored;
  const Program program = parse(SourceText("", std::string(word)), ignored);
  for (const Word& each : program.words) {
    for (const DroppableWord& row : kWords) {
      if (each.letter == 'G' && code_of(each) == row.code) return row.name;
    }
  }
  return {};
}

SourceText without_words(const SourceText& source, const std::vector<std::string>& names,
                         std::size_t& dropped) {
  if (!language_marks(source).empty()) return source;
  std::vector<const DroppableWord*> rows;
  for (const std::string& name : names) {
    const DroppableWord* row = find(name);
    if (row != nullptr && !(row->code == kWords[0].code && needs_g64(source.text()))) {
      rows.push_back(row);
    }
  }
  if (rows.empty()) return source;
  std::string text;
  LineCursor lines(source.text());
  while (const auto bounds = lines.next()) {
    std::string line(source.text({bounds->begin, bounds->text_end}));
    for (const DroppableWord* row : rows) dropped += drop_in(line, *row);
    text += line;
    text += source.text({bounds->text_end, bounds->end});
  }
  return dropped == 0 ? source : SourceText(source.name(), std::move(text));
}

}  // namespace batten::gcode
